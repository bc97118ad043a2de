// A copy button for every table (as tab-separated values) and every block of commands.
function textOf(figure) {
  const table = figure.querySelector("table");
  if (!table) return figure.querySelector("pre").textContent;
  const rows = [...table.rows].filter((row) => !row.classList.contains("groups"));
  return rows.map((row) => [...row.cells].map((cell) => cell.dataset.head ?? cell.textContent).join("\t")).join("\n");
}
function copyByHand(text) {
  const box = document.body.appendChild(document.createElement("textarea"));
  box.value = text;
  box.select();
  document.execCommand("copy");
  box.remove();
}
for (const figure of document.querySelectorAll("figure.table, figure.code")) {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = "copy";
  button.onclick = async () => {
    const text = textOf(figure);
    try { await navigator.clipboard.writeText(text); } catch { copyByHand(text); }
    button.textContent = "copied";
    setTimeout(() => { button.textContent = "copy"; }, 1500);
  };
  figure.prepend(button);
}
