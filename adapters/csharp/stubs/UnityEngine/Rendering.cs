namespace UnityEngine.Rendering
{
    public class RenderPipelineAsset : ScriptableObject
    {
        public virtual Material defaultMaterial { get; set; }
    }

    public static class GraphicsSettings
    {
        public static RenderPipelineAsset currentRenderPipeline { get; set; }
    }
}
