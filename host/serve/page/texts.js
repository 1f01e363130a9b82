// The texts of the page, which the server has put into its document: English, or those of
// `lamplock serve --texts` with English where the translation has none.

const table = JSON.parse(document.getElementById('texts').textContent);

// The text of a name; {value} in it becomes values.value.
export const text = (name, values = {}) => table[name].replace(/\{(\w+)\}/g, (_, value) => values[value]);
