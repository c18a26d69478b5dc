/** Whether the browser renders in software, on a processor that the server may need. */

const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

let known: boolean | undefined;

export function drawnBySoftware(): boolean {
  known ??= looked();
  return known;
}

/** Return whether the address contains `power=all`: frames then follow without pause, to measure their rate. */
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
