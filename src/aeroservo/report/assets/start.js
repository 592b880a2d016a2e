"use strict";
/* Scenes and panels start when they come near the screen: the first paint waits for none of them. */
(() => {
  const page = window.aeroservoPage;
  page.scenes = [];
  page.live = [];
  const begin = (box) => {
    if (box.started) return;
    box.started = true;
    const stage = box.querySelector(".stage");
    if (box.dataset.scenes !== undefined) page.scenes[box.dataset.scenes] = createWing(stage, page.data.scenes[box.dataset.scenes]);
    else page.live[box.dataset.live] = createLive(stage, page.data.live[box.dataset.live]);
  };
  const watch = new IntersectionObserver((entries) => {
    for (const e of entries) if (e.isIntersecting) { watch.unobserve(e.target); begin(e.target); }
  }, { rootMargin: "300px" });
  document.querySelectorAll(".moving").forEach((box) => watch.observe(box));
  addEventListener("beforeprint", () => document.querySelectorAll(".moving").forEach(begin)); // paper shows them all
})();
