
// Worker that answers one request at a time. The first message is the engine's WebAssembly, gzipped and in base64.
const unpacked = async text => {
  const bytes = Uint8Array.from(atob(text.trim()), c => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
};
let engine;
onmessage = async ({data}) => {
  if (!engine) return void (engine = unpacked(data).then(wasmBinary => ukemiEngine({wasmBinary})));
  let answer;
  try {
    const {ccall} = await engine;
    answer = JSON.parse(ccall('ukemi_answer', 'string', ['string'], [JSON.stringify(data)]));
  } catch (error) {
    answer = {error: `The engine cannot run here (${error.message}). A newer browser may do.`};
  }
  postMessage(answer);
};
