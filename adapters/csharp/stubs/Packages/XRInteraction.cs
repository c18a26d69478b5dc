using UnityEngine.Events;

namespace UnityEngine.XR.Interaction.Toolkit
{
    public sealed class HoverEnterEventArgs
    {
    }

    public sealed class HoverExitEventArgs
    {
    }

    public sealed class SelectEnterEventArgs
    {
    }

    public sealed class SelectExitEventArgs
    {
    }
}

#if PACINIAN_XRI_3
namespace UnityEngine.XR.Interaction.Toolkit.Interactables
#else
namespace UnityEngine.XR.Interaction.Toolkit
#endif
{
    public class XRBaseInteractable : MonoBehaviour
    {
        public UnityEvent<HoverEnterEventArgs> hoverEntered { get; } = new UnityEvent<HoverEnterEventArgs>();

        public UnityEvent<HoverExitEventArgs> hoverExited { get; } = new UnityEvent<HoverExitEventArgs>();

        public UnityEvent<SelectEnterEventArgs> selectEntered { get; } = new UnityEvent<SelectEnterEventArgs>();

        public UnityEvent<SelectExitEventArgs> selectExited { get; } = new UnityEvent<SelectExitEventArgs>();

        public bool isHovered { get; set; }

        public bool isSelected { get; set; }
    }
}
