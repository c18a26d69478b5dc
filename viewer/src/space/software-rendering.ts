/** Whether frames are drawn by the processor, which the server may need more than we do. */

const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

let known: boolean | undefined;

export function drawnBySoftware(): boolean {
  known ??= looked();
  return known;
}

/** Whether the address says `power=all`: frames one after the other, changed or not, to see how many there can be. */
export function allPower(): boolean {
  return new URLSearchParams(location.search).get("power") === "all";
}

function looked(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return true;
  const told = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(told ? told.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return SOFTWARE.test(name);
}
