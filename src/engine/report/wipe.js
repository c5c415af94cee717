(() => {
  const wipe = document.getElementById("wipe");
  const shown = [...document.querySelectorAll(".pictures img")].slice(0, 2);
  if (shown.length < 2) return;
  const [under, over] = wipe.querySelectorAll("img");
  const names = wipe.querySelectorAll(".wipe-bar span");
  const range = wipe.querySelector("input");
  // The second picture lies below; the first one is cut off at the line.
  [over, under].forEach((image, i) => {
    image.src = shown[i].src;
    image.alt = names[i].textContent = shown[i].alt;
  });
  const move = () => {
    over.style.clipPath = `inset(0 ${100 - range.value}% 0 0)`;
    wipe.querySelector(".wipe").style.setProperty("--at", `${range.value}%`);
  };
  range.addEventListener("input", move);
  wipe.querySelector(".wipe").addEventListener("pointermove", (event) => {
    if (event.buttons !== 1 && event.pointerType === "mouse") return;
    const box = event.currentTarget.getBoundingClientRect();
    range.value = ((event.clientX - box.left) / box.width) * 100;
    move();
  });
  const [width, height] = [shown[0].naturalWidth, shown[0].naturalHeight];
  if (height) wipe.querySelector(".wipe").style.setProperty("--aspect", width / height);
  move();
  wipe.hidden = false;
})();
