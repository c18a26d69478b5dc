using UnityEngine;
using UnityEngine.Rendering;

namespace Pacinian.Samples
{
    /// <summary>Gives its object the render pipeline's default material. Otherwise the object would be pink with URP or HDRP.</summary>
    [ExecuteAlways]
    [AddComponentMenu("Pacinian/Samples/Pipeline Material")]
    public sealed class PipelineMaterial : MonoBehaviour
    {
        private void OnEnable()
        {
            RenderPipelineAsset pipeline = GraphicsSettings.currentRenderPipeline; // null: the built-in one
            if (pipeline != null && pipeline.defaultMaterial != null)
            {
                GetComponent<Renderer>().sharedMaterial = pipeline.defaultMaterial;
            }
        }
    }
}
