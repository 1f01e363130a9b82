// The texts of the page, which the server has put into its document: English, or those of
// `lamplock serve --texts` with English where the translation has none.

const table = JSON.parse(document.getElementById('texts').textContent);

// The text of a name; {value} in it becomes values.value.
export const text = (name, values = {}) => table[name].replace(/\{(\w+)\}/g, (_, value) => values[value]);

// The text of a code of the server, such as a state of the board; the code itself if there is none.
export const word = (group, code, other = code) => table[`${group}.${code.toLowerCase().replaceAll(' ', '-')}`] ?? other;

// The message of an error of the server, which is in the language of the page if the error has a name.
// A server that is newer than the page may have others.
export const error_text = ({ message, data }) =>
  table[`error.${data?.name}`] === undefined ? message : text(`error.${data.name}`, data.values);
