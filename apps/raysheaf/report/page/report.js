// Without this script the page shows all layers side by side; with it, two of them under a slider.
"use strict";
(() => {
  const find = (id) => document.getElementById(id);
  const layers = new Map(
      Array.from(document.querySelectorAll("img.layer"), (image) => [image.id.slice(6), image]));
  const left = find("left"), right = find("right"), place = find("place"), stage = find("stage");

  const show = (select, image, tag) => {
    const layer = layers.get(select.value);
    image.src = layer.src;
    image.alt = layer.alt;
    tag.textContent = layer.dataset.title;
    return layer.dataset;
  };
  const tell = () => {
    const over = show(left, find("over"), find("tag-left"));
    const under = show(right, find("under"), find("tag-right"));
    find("told").textContent = over.title === under.title
        ? `${over.title}: ${over.text}`
        : `Left, ${over.title.toLowerCase()}: ${over.text} Right, ${under.title.toLowerCase()}: ${under.text}`;
  };
  const move = () => {
    stage.style.setProperty("--place", `${place.value}%`);
    find("place-told").textContent = `${place.value} %`;
    place.setAttribute("aria-valuetext", `${place.value} % left layer`);
  };
  // The address contains the choice: #view=beauty,tests-rah,40
  const remember = () => {
    try {
      history.replaceState(null, "", `#view=${left.value},${right.value},${place.value}`);
    } catch {
      // Some browsers refuse this for files; only the address is lost.
    }
  };
  const recall = () => {
    const words = /^#view=([\w-]+),([\w-]+),(\d+)$/.exec(location.hash);
    if (!words || !layers.has(words[1]) || !layers.has(words[2])) return;
    [left.value, right.value, place.value] = words.slice(1);
  };

  for (const select of [left, right])
    for (const [id, image] of layers) select.add(new Option(image.dataset.title, id));
  const heat = Array.from(layers.keys()).filter((id) => id.startsWith("tests-"));
  left.value = "beauty";
  right.value = heat.length ? heat[heat.length - 1] : "normal";
  recall();
  for (const select of [left, right])
    select.addEventListener("change", () => { tell(); remember(); });
  place.addEventListener("input", move);
  place.addEventListener("change", remember);
  find("swap").addEventListener("click", () => {
    [left.value, right.value] = [right.value, left.value];
    tell();
    remember();
  });

  const drag = (event) => {
    const box = stage.getBoundingClientRect();
    place.value = Math.round(100 * (event.clientX - box.left) / box.width);
    move();
  };
  stage.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    stage.setPointerCapture(event.pointerId);
    drag(event);
  });
  stage.addEventListener("pointermove", (event) => { if (event.buttons & 1) drag(event); });
  stage.addEventListener("pointerup", remember);

  tell();
  move();
  find("wipe").hidden = false;
  document.querySelector(".gallery").open = false;

  // Printing shows the parts that are folded on the screen.
  let folded = [];
  addEventListener("beforeprint", () => {
    folded = Array.from(document.querySelectorAll("details:not([open])"));
    for (const details of folded) details.open = true;
  });
  addEventListener("afterprint", () => { for (const details of folded) details.open = false; });

  const copy = async (text) => {
    if (navigator.clipboard) return navigator.clipboard.writeText(text);
    const area = document.body.appendChild(document.createElement("textarea"));
    area.value = text;
    area.select();
    document.execCommand("copy");
    area.remove();
  };
  for (const button of document.querySelectorAll(".copy")) {
    button.hidden = false;
    button.addEventListener("click", async () => {
      await copy(button.previousElementSibling.textContent);
      button.textContent = "Copied";
      setTimeout(() => { button.textContent = "Copy"; }, 1500);
    });
  }

  find("save").hidden = false;
  find("save").addEventListener("click", () => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(
        new Blob([find("raysheaf-data").textContent], {type: "application/json"}));
    link.download = "raysheaf-report.json";
    link.click();
    URL.revokeObjectURL(link.href);
  });
})();
