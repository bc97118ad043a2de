"""The run file as it is written: every key with its type, its default and what it means."""

from typing import Annotated, Literal, get_args

from pydantic import BeforeValidator, ConfigDict, Field

from ikde.formats.entries import (
    MAX_ATTACHED,
    AnyTarget,
    AsEntry,
    AsText,
    Count,
    DetectorChoice,
    Entry,
    FileEntry,
    HeldChoice,
    Interval,
    MarginChoice,
    Number,
    OrientationEntry,
    TextOrEntry,
    UnitsEntry,
    Vector,
)
from ikde.formats.goal_entries import FreedomEntry, NamedGoalEntry, refuse_nothing
from ikde.formats.names import Name, Text
from ikde.kernels.mutation import REPAIRS, STRATEGIES
from ikde.model.target import TargetKind
from ikde.solver.engine_table import Method
from ikde.solver.settings import Collision, Update

ColumnGroup = Literal["q", "errors", "clearance", "cost", "reason", "target"]
COLUMN_GROUPS: tuple[ColumnGroup, ...] = get_args(ColumnGroup)

MAX_ARMS, MAX_GRADERS = 1000, 100  # of a run
GridCounts = Annotated[list[Annotated[int, Field(strict=True, ge=1, le=10**6)]], Field(min_length=3, max_length=3)]


class ReachableEntry(Entry):
    """Where the tool is in random configurations that are inside the ranges of `solve` and free of collision."""

    count: Count
    """How many targets."""
    goal: TargetKind = "position"
    """What is asked of the tool there."""
    detector: Name | None = None
    """What the configurations are free for: a detector's name or `none` (default: the robot's own)."""


class GridEntry(Entry):
    """Points of a regular grid; z runs fastest."""

    start: Vector = Field(alias="from")
    """First corner."""
    to: Vector
    """Last corner."""
    counts: GridCounts
    """Points along x, y, z; a single one stands at `from`."""
    orientation: OrientationEntry | None = None
    """The orientation of the tool at every point."""


class BoxEntry(Entry):
    """Random points, uniform in a box."""

    start: Vector = Field(alias="from")
    """One corner."""
    to: Vector
    """The opposite corner."""
    count: Count
    """How many targets."""
    orientation: OrientationEntry | None = None
    """The orientation of the tool at every point."""


class BallEntry(Entry):
    """Random points, uniform in a ball or on its surface."""

    center: Vector
    """Middle."""
    radius: Annotated[Number, Field(gt=0.0)]
    """Radius."""
    count: Count
    """How many targets."""
    filled: bool = True
    """Whether points lie inside (true) or on the surface (false)."""
    orientation: OrientationEntry | None = None
    """The orientation of the tool at every point."""


class TargetsEntry(Entry):
    """Where targets come from: exactly one key."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})
    inline: Annotated[list[AnyTarget], Field(min_length=1)] | None = None
    """A list, written here."""
    goals: Annotated[list[NamedGoalEntry], Field(min_length=1)] | None = None
    """A list of goals with freedom."""
    file: FileEntry | None = None
    """A table: CSV, Parquet or NPZ."""
    reachable: ReachableEntry | None = None
    """Targets that the robot can reach."""
    grid: GridEntry | None = None
    """A regular grid."""
    box: BoxEntry | None = None
    """Random points in a box."""
    sphere: BallEntry | None = None
    """Random points in a ball or on its surface."""


class DeEntry(Entry):
    """Settings of the method `de`, the differential evolution of the papers."""

    strategy: str | None = Field(default=None, json_schema_extra={"enum": [*STRATEGIES, None]})
    """Mutation."""
    population: int | None = None
    """Members of the population, NP."""
    start_share: Number | None = None
    """Share of each range, about its middle, that the first population is drawn from."""
    weight: Number | None = None
    """Differential weight, F."""
    crossover: Number | None = None
    """Crossover rate, CR, 0 to 1."""
    generations: int | None = None
    """Generations of one attempt."""
    bounds: str | None = Field(default=None, json_schema_extra={"enum": [*REPAIRS, None]})
    """What happens to a coordinate out of its range; `memetic` uses it, too."""
    update: Update | None = None
    """When a better trial replaces its parent."""
    collision: Collision | None = None
    """`reject`: test the best, start again until it is free; `feasibility`: inside the selection; `memetic` uses it."""


class SettingsEntry(Entry):
    """How to search; what is left out is the method's own choice."""

    position_tolerance: Number | None = None
    """Accepted distance from the target."""
    orientation_tolerance: Number | None = None
    """Accepted angle from the target."""
    restarts: int | None = None
    """Attempts before the budget is spent."""
    timeout_s: Number | None = None
    """Seconds after which no further attempt at a target is begun. The answers may then depend on the machine."""
    de: DeEntry | None = None
    """What belongs to the method `de`."""


class SolveEntry(Entry):
    """How to solve."""

    method: Method = "auto"
    """The engine: `auto` is ikde's choice, `de` the search of the paper."""
    detector: DetectorChoice | None = None
    """What counts as self-collision: a name, `none`, or a detector of your own (default: the robot's)."""
    margin: MarginChoice | None = None
    """Distance to keep from the world; `10,gripper=0`: that of a component in its place."""
    settings: SettingsEntry = SettingsEntry()
    """How to search."""
    ranges: dict[Name, Interval] = {}
    """Joint ranges instead of the robot's: joint: [lower, upper]."""
    near: dict[Name, Number] | None = None
    """Joint values to stay close to; joints left out stay near home."""
    weights: dict[Name, Number] = {}
    """Weights of joints in the motion from `near`, per m or rad; joints left out have the robot's own."""
    freeze: dict[Name, Number | None] = {}
    """Joints that must not move, with their value (null: from `near`, else home)."""


class MoveEntry(Entry):
    """How far an obstacle is moved at random, uniformly."""

    by: Vector = [0.0, 0.0, 0.0]
    """At most so far along x, y and z, either way."""
    turn: Annotated[Number, Field(ge=0.0)] = 0.0
    """At most so far about z through its own origin, either way."""


class WorldEntry(Entry):
    """A world, or several that differ by where some obstacles stand."""

    path: Text
    """A world file, a cuRobo scene or a MoveIt planning scene, relative to the run file; `none` for no world."""
    name: Name | None = None
    """What to call it in the results (default: the file's name)."""
    move: dict[Name, MoveEntry] = {}
    """Obstacles that stand elsewhere, by name."""
    count: Annotated[int, Field(strict=True, ge=1, le=MAX_ARMS)] = 1
    """How many such worlds."""


WorldChoice = Annotated[Annotated[Text, AsText] | Annotated[WorldEntry, AsEntry], TextOrEntry]


class OutputEntry(Entry):
    """What the results hold."""

    columns: list[ColumnGroup] = list(COLUMN_GROUPS)
    """Groups of columns besides arm, target, repeat, reached, collision, verified and stop_reason."""


class BatchSpec(Entry):
    """A run: many targets, solved in one or several ways."""

    name: Name | None = None
    """What to call the run (default: the file's name)."""
    robot: Text
    """A robot that ships with ikde, or its file, relative to the run file."""
    tool: Name | None = None
    """Which of its tools, or a frame (default: as the robot's file says); joints that do not move it are held."""
    units: UnitsEntry = UnitsEntry()
    """Units of everything written here."""
    targets: TargetsEntry
    """What to reach."""
    freedom: Annotated[FreedomEntry | None, BeforeValidator(refuse_nothing)] = None
    """How far off each target the tool may be, and where a planar base may stand: makes goals with freedom of them."""
    solve: SolveEntry = SolveEntry()
    """How to solve."""
    world: WorldChoice | None = None
    """What stands around the robot: a file, or one with obstacles moved."""
    worlds: Annotated[list[WorldChoice], Field(min_length=1, max_length=MAX_ARMS)] | None = None
    """Several worlds, in each of which every arm solves every target."""
    attached: Annotated[dict[Name, HeldChoice], Field(max_length=MAX_ATTACHED)] = {}
    """Obstacles of each world that the robot picks up at `near` of `solve`, else at home: object: frame."""
    arms: Annotated[dict[Name, SolveEntry], Field(max_length=MAX_ARMS)] = {}
    """Several ways to solve, compared over the same targets and random streams; each is laid over `solve`."""
    grade: Annotated[list[DetectorChoice], Field(max_length=MAX_GRADERS)] = []
    """Further detectors that grade every solution."""
    repeats: Count = 1
    """How often each target is solved, each time with its own random stream."""
    seed: Annotated[int, Field(strict=True, ge=0, le=2**64 - 1)] = 0
    """Same seed, same answers."""
    chunk: Annotated[int, Field(strict=True, ge=1, le=10**6)] | None = None
    """Solves in one file of the results: a kill costs at most a file a thread and one more (default: a hundredth of an
    arm's solves, 1000 to 10000; of goals with freedom 20 to 1000)."""
    explain: bool = True
    """Whether to find out why a target was not reached."""
    output: OutputEntry = OutputEntry()
    """What the results hold."""
