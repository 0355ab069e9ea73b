// Arrays of numbers, packed by src/page/drawn_faces.cpp: base64, zlib, bytes by planes.
const kinds = {u1: Uint8Array, u2: Uint16Array, u4: Uint32Array, f4: Float32Array};

async function inflated(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < bytes.length; ++k) bytes[k] = letters.charCodeAt(k);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// three.js and its controls.
async function loadThree(packed) {
  const script = document.createElement("script");
  script.textContent = new TextDecoder().decode(await inflated(packed));
  document.head.append(script);
}

async function unpacked(packed) {
  const planes = await inflated(packed.packed);
  const Kind = kinds[packed.type];
  const width = Kind.BYTES_PER_ELEMENT;
  const count = planes.length / width;
  const bytes = new Uint8Array(planes.length);
  for (let byte = 0; byte < width; ++byte) {
    for (let k = 0; k < count; ++k) bytes[k * width + byte] = planes[byte * count + k];
  }
  return new Kind(bytes.buffer);
}

async function unpackedAll(parts) {
  const arrays = {};
  for (const [name, part] of Object.entries(parts)) arrays[name] = await unpacked(part);
  return arrays;
}
