// What the page carries: `luxel bake` puts it into script elements that no browser runs.

/** Once: what has been read need not stay in memory. */
function text(id) {
  const element = document.getElementById(id);
  element.remove();
  return element.textContent;
}

async function inflate(id) {
  const bytes = Uint8Array.from(atob(text(id)), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/** Title, counts, camera, exposure, sizes and scales of the pictures. */
export const about = () => JSON.parse(text("about"));
/** The bytes of baked.glb. */
export const model = () => inflate("model");
/** A picture / its scale as 16-bit floats, RGBA, the top row first. `about` says which. */
export const picture = async (about) => new Uint16Array(await inflate(about.id));
