// The Levenberg-Marquardt loop of pinocchio.py in C++ over Pinocchio's headers, with restarts and the sphere check.
// It looks at spheres as ikde's kernels do: bounding spheres first, then all spheres of a pair, first contact ends it.

#include <chrono>
#include <cstdint>
#include <vector>

#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/spatial.hpp>

using Eigen::Vector3d;
using RowMatrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

struct Sphere {
  Vector3d p;
  double r;
};

struct Component {
  int joint;
  Sphere bound;
  std::vector<Sphere> spheres;
};

struct Solver {
  pinocchio::Model model;
  pinocchio::Data data;
  pinocchio::JointIndex tool_joint;
  pinocchio::SE3 tool;
  Eigen::VectorXd lower, upper;
  double p_tolerance, R_tolerance, safe_distance, least_damping, damping, largest_step;
  int is_pose, steps;
  std::vector<Component> components;
  std::vector<std::pair<int, int>> pairs;
  std::vector<Vector3d> bounds;
  std::vector<std::vector<Vector3d>> centres;
  std::vector<char> placed;
  Eigen::Matrix<double, 6, Eigen::Dynamic> J;
  uint64_t state;

  double uniform() {  // splitmix64
    uint64_t z = (state += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return double((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

  void place(int c) {
    if (placed[c]) return;
    placed[c] = 1;
    const auto& M = data.oMi[components[c].joint];
    for (size_t k = 0; k < components[c].spheres.size(); ++k) centres[c][k] = M.act(components[c].spheres[k].p);
  }

  bool touch(int a, int b) {
    const double whole = components[a].bound.r + components[b].bound.r + safe_distance;
    if ((bounds[a] - bounds[b]).squaredNorm() > whole * whole) return false;
    place(a);
    place(b);
    for (size_t j = 0; j < components[b].spheres.size(); ++j) {
      const double reach = components[b].spheres[j].r + safe_distance;
      for (size_t i = 0; i < components[a].spheres.size(); ++i) {
        const double limit = components[a].spheres[i].r + reach;
        if ((centres[a][i] - centres[b][j]).squaredNorm() <= limit * limit) return true;
      }
    }
    return false;
  }

  // Whether the configuration of the last forward kinematics is free of self-collision.
  bool is_free() {
    for (size_t c = 0; c < components.size(); ++c) {
      bounds[c] = data.oMi[components[c].joint].act(components[c].bound.p);
      placed[c] = 0;
    }
    for (const auto& pair : pairs)
      if (touch(pair.first, pair.second)) return false;
    return true;
  }

  void draw_free(Eigen::VectorXd& q) {
    do {
      for (int k = 0; k < q.size(); ++k) q[k] = lower[k] + (upper[k] - lower[k]) * uniform();
      pinocchio::forwardKinematics(model, data, q);
    } while (!is_free());
  }

  template <int Rows>
  bool descend(const pinocchio::SE3& target, Eigen::VectorXd& q) {
    Eigen::Matrix<double, Rows, 1> error;
    Eigen::Matrix<double, Rows, Rows> A;
    for (int step = 0; step < steps; ++step) {
      pinocchio::computeJointJacobians(model, data, q);
      const pinocchio::SE3 T = data.oMi[tool_joint] * tool;
      error.template head<3>() = T.rotation().transpose() * (target.translation() - T.translation());
      bool there = error.template head<3>().norm() <= p_tolerance;
      if (Rows == 6) {
        error.template tail<3>() = pinocchio::log3(Eigen::Matrix3d(T.rotation().transpose() * target.rotation()));
        there = there && error.template tail<3>().norm() <= R_tolerance;
      }
      if (there) return true;
      J.setZero();
      pinocchio::getJointJacobian(model, data, tool_joint, pinocchio::LOCAL, J);
      J = tool.toActionMatrixInverse() * J;
      const auto rows = J.template topRows<Rows>();
      A.noalias() = rows * rows.transpose();
      A.diagonal().array() += least_damping + damping * error.squaredNorm();
      Eigen::VectorXd move = rows.transpose() * A.ldlt().solve(error);
      const double longest = move.cwiseAbs().maxCoeff();
      if (longest > largest_step) move *= largest_step / longest;
      q = (q + move).cwiseMax(lower).cwiseMin(upper);
    }
    return false;
  }
};

extern "C" void* make(const double* x, const int* n, unsigned long long seed) {
  auto* s = new Solver;
  const int joints = *n++;
  s->is_pose = *n++;
  for (int k = 0; k < joints; ++k) {
    const int parent = *n++, slides = *n++;
    const pinocchio::SE3 M(Eigen::Map<const RowMatrix>(x), Eigen::Map<const Vector3d>(x + 9));
    const Vector3d axis = Eigen::Map<const Vector3d>(x + 12);
    x += 15;
    const std::string name = "j" + std::to_string(k);
    if (slides)
      s->model.addJoint(parent, pinocchio::JointModelPrismaticUnaligned(axis), M, name);
    else
      s->model.addJoint(parent, pinocchio::JointModelRevoluteUnaligned(axis), M, name);
  }
  s->tool_joint = *n++;
  s->tool = pinocchio::SE3(Eigen::Map<const RowMatrix>(x), Eigen::Map<const Vector3d>(x + 9));
  x += 12;
  s->lower = Eigen::Map<const Eigen::VectorXd>(x, joints);
  s->upper = Eigen::Map<const Eigen::VectorXd>(x + joints, joints);
  x += 2 * joints;
  s->p_tolerance = *x++;
  s->R_tolerance = *x++;
  s->safe_distance = *x++;
  s->least_damping = *x++;
  s->damping = *x++;
  s->largest_step = *x++;
  s->steps = *n++;
  const int components = *n++;
  for (int c = 0; c < components; ++c) {
    Component component;
    component.joint = *n++;
    const int count = *n++;
    component.bound = {Eigen::Map<const Vector3d>(x), x[3]};
    x += 4;
    for (int k = 0; k < count; ++k, x += 4) component.spheres.push_back({Eigen::Map<const Vector3d>(x), x[3]});
    s->components.push_back(component);
    s->centres.emplace_back(count);
  }
  s->bounds.resize(components);
  s->placed.resize(components);
  const int pairs = *n++;
  for (int k = 0; k < pairs; ++k, n += 2) s->pairs.emplace_back(n[0], n[1]);
  s->data = pinocchio::Data(s->model);
  s->J.resize(6, joints);
  s->state = seed;
  return s;
}

extern "C" int solve(void* solver, const double* target, double* out_q, double seconds) {
  auto& s = *static_cast<Solver*>(solver);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  const pinocchio::SE3 T(Eigen::Map<const RowMatrix>(target + 3), Eigen::Map<const Vector3d>(target));
  Eigen::VectorXd q(s.model.nq);
  do {
    s.draw_free(q);
    if ((s.is_pose ? s.descend<6>(T, q) : s.descend<3>(T, q)) && s.is_free()) {
      Eigen::Map<Eigen::VectorXd>(out_q, q.size()) = q;
      return 1;
    }
  } while (std::chrono::steady_clock::now() < end);
  return 0;
}
