// Elements of the page. Whatever comes from a model becomes text, never HTML.
function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

const byId = (id) => document.getElementById(id);

// A table with a caption; cells are texts, numbers or elements.
function table(caption, heads, rows) {
  const reads = (cell) => typeof cell === "number" || cell === null || /^((~ )?-?[\d.,]+(e[+-]?\d+)?(\u00a0%)?|not known|no bound|unlimited)$/.test(cell);
  const isNumber = heads.map((_, column) => rows.length > 0 && rows.every((row) => reads(row[column])));
  const cell = (content, column) => {
    const made = element("td", isNumber[column] ? {class: "number"} : {});
    made.append(typeof content === "number" || content === null ? shown(content) : content);
    return made;
  };
  const head = heads.map((text, column) => element("th", {scope: "col", class: isNumber[column] ? "number" : ""}, text));
  const lines = rows.map((row) => element("tr", {}, ...row.map(cell)));
  const whole = element("table", {}, element("caption", {}, caption), element("thead", {}, element("tr", {}, ...head)), element("tbody", {}, ...lines));
  return element("div", {class: "scroll", tabindex: "0", role: "region", "aria-label": caption}, whole);
}

function list(texts) {
  return element("ul", {}, ...texts.map((text) => element("li", {}, text)));
}

// A section with its heading, at the end of the tables, rooms and sensors before the images; nothing without content.
function section(id, heading, ...content) {
  const kept = content.filter((part) => part !== null && part !== undefined);
  if (kept.length === 0) return;
  byId(id === "rooms" || id === "sensors" ? "results" : "tables").append(element("section", {id}, element("h2", {}, heading), ...kept));
}
