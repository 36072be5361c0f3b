
// Answers one request after the other, away from the page.
const engine = ukemiEngine();
onmessage = async ({data}) => {
  const {ccall} = await engine;
  postMessage(JSON.parse(ccall('ukemi_answer', 'string', ['string'], [JSON.stringify(data)])));
};
