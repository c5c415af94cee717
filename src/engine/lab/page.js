(() => {
  const by = (id) => document.getElementById(id);
  const cells = [...document.querySelectorAll("[data-cells]")];
  const marks = [...document.querySelectorAll("[data-marks]")];
  const rows = [...document.querySelectorAll("[data-row]")];
  const [at, play] = [by("at"), by("play")];
  let timer = 0;
  const show = () => {
    const now = Number(at.value);
    cells.forEach((group, i) => { group.style.display = i < now ? "inline" : "none"; });
    marks.forEach((group, i) => { group.style.display = i + 1 === now ? "inline" : "none"; });
    rows.forEach((row, i) => row.classList.toggle("current", i + 1 === now));
    const row = rows[now - 1];
    by("now").textContent = row ? `${row.cells[0].textContent}: ${row.cells[1].textContent}` : "Before the first step";
    if (row) {
      const box = row.closest(".steps");
      box.scrollTop = row.offsetTop - box.clientHeight / 2;
    }
  };
  const go = (step) => {
    at.value = step;
    show();
  };
  const stop = () => {
    clearInterval(timer);
    timer = 0;
    play.textContent = "Play";
  };
  by("back").addEventListener("click", () => go(Number(at.value) - 1));
  by("forward").addEventListener("click", () => go(Number(at.value) + 1));
  at.addEventListener("input", show);
  play.addEventListener("click", () => {
    if (timer) return stop();
    if (Number(at.value) === rows.length) go(0);
    play.textContent = "Pause";
    timer = setInterval(() => (Number(at.value) < rows.length ? go(Number(at.value) + 1) : stop()), 120);
  });
  rows.forEach((row, i) => row.addEventListener("click", () => go(i + 1)));
  at.max = rows.length;
  go(rows.length);
  by("controls").hidden = false;
})();
