(() => {
  "use strict";
  const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const dark = matchMedia("(prefers-color-scheme: dark)");
  // On a touch screen a finger scrolls the page; it must not get caught in a plot.
  const touch = matchMedia("(pointer: coarse)").matches;
  const narrow = matchMedia("(max-width: 760px)").matches;
  const plots = [...document.querySelectorAll(".plot")];

  /** The page's colours for a layout, as changes to make to it. */
  const colours = (layout) => {
    const change = {
      "font.color": style("--text"),
      paper_bgcolor: "rgba(0,0,0,0)",
      plot_bgcolor: "rgba(0,0,0,0)",
      "hoverlabel.bgcolor": style("--panel"),
      "hoverlabel.bordercolor": style("--rule"),
      "hoverlabel.font.color": style("--text"),
      "modebar.bgcolor": "rgba(0,0,0,0)",
      "modebar.color": style("--rule"),
      "modebar.activecolor": style("--soft"),
    };
    const axes = Object.keys(layout).filter((key) => /^[xy]axis/.test(key));
    const inSpace = ["x", "y", "z"].map((axis) => `scene.${axis}axis`);
    for (const axis of layout.scene ? inSpace : axes) {
      change[`${axis}.gridcolor`] = style(layout.scene ? "--rule" : "--grid");
      change[`${axis}.linecolor`] = style("--rule");
      change[`${axis}.zerolinecolor`] = style("--rule");
      if (layout.scene) change[`${axis}.backgroundcolor`] = style("--page");
    }
    return change;
  };

  const draw = (div) => {
    const { data, layout, config } = JSON.parse(document.getElementById(`data-${div.id}`).textContent);
    if (div.dataset.overTime !== undefined) {
      layout.hoversubplots = "axis";
      if (touch) layout.dragmode = false;
    } else if (!layout.scene) {
      layout.dragmode = touch ? false : "pan";
    }
    if (layout.scene && narrow) {
      layout.height = 400;
      div.style.height = "400px";
      for (const axis of "xyz") layout.scene.camera.eye[axis] *= 1.7;
    }
    config.displayModeBar = touch || narrow ? false : "hover";
    config.modeBarButtonsToRemove = ["select2d", "lasso2d", "autoScale2d"];
    return Plotly.newPlot(div, data, layout, config).then(() => Plotly.relayout(div, colours(layout)));
  };

  /** Zooming one plot over time zooms them all. */
  const link = (all) => {
    let busy = false;
    const follow = (from, change) => {
      const range = change["xaxis.range"] || [change["xaxis.range[0]"], change["xaxis.range[1]"]];
      const to = change["xaxis.autorange"] ? { "xaxis.autorange": true } : { "xaxis.range": range };
      if (busy || (to["xaxis.range"] && range[0] === undefined)) return;
      busy = true;
      Promise.all(all.filter((div) => div !== from).map((div) => Plotly.relayout(div, to)))
        .finally(() => { busy = false; });
    };
    for (const div of all) div.on("plotly_relayout", (change) => follow(div, change));
  };

  Promise.all(plots.map(draw)).then(() => {
    link(plots.filter((div) => div.dataset.overTime !== undefined));
    dark.addEventListener("change", () => {
      for (const div of plots) Plotly.relayout(div, colours(div.layout));
    });
  });
})();
