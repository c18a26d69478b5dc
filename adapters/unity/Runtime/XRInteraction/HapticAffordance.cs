using UnityEngine;
using UnityEngine.XR.Interaction.Toolkit;
#if PACINIAN_XRI_3
using UnityEngine.XR.Interaction.Toolkit.Interactables;
#endif

namespace Pacinian.Haptics
{
    /// <summary>
    /// Plays effects when an interactable of the XR Interaction Toolkit on the same object is hovered over or selected.
    /// Switch Play On Enable of the effects off.
    /// </summary>
    [AddComponentMenu("Pacinian/Haptic Affordance")]
    [RequireComponent(typeof(XRBaseInteractable))]
    public sealed class HapticAffordance : MonoBehaviour
    {
        [SerializeField, Tooltip("Effect that plays while the object is hovered over.")] private HapticEffect whileHovered;
        [SerializeField, Tooltip("Effect that plays while the object is selected, for example grabbed or pressed.")]
        private HapticEffect whileSelected;

        private XRBaseInteractable _interactable;

        /// <summary>
        /// The effect that plays while the object is hovered over: until the last interactor leaves, or its duration is
        /// over.
        /// </summary>
        public HapticEffect WhileHovered
        {
            get { return whileHovered; }
            set { whileHovered = value; }
        }

        /// <summary>
        /// The effect that plays while the object is selected, for example grabbed or pressed, or until its duration is
        /// over.
        /// </summary>
        public HapticEffect WhileSelected
        {
            get { return whileSelected; }
            set { whileSelected = value; }
        }

        private void OnEnable()
        {
            _interactable = GetComponent<XRBaseInteractable>();
            _interactable.hoverEntered.AddListener(Hover);
            _interactable.hoverExited.AddListener(Leave);
            _interactable.selectEntered.AddListener(Select);
            _interactable.selectExited.AddListener(Release);
        }

        private void OnDisable()
        {
            _interactable.hoverEntered.RemoveListener(Hover);
            _interactable.hoverExited.RemoveListener(Leave);
            _interactable.selectEntered.RemoveListener(Select);
            _interactable.selectExited.RemoveListener(Release);
            End(whileHovered);
            End(whileSelected);
        }

        private void Hover(HoverEnterEventArgs what)
        {
            Begin(whileHovered);
        }

        private void Leave(HoverExitEventArgs what)
        {
            if (!_interactable.isHovered)
            {
                End(whileHovered);
            }
        }

        private void Select(SelectEnterEventArgs what)
        {
            Begin(whileSelected);
        }

        private void Release(SelectExitEventArgs what)
        {
            if (!_interactable.isSelected)
            {
                End(whileSelected);
            }
        }

        private static void Begin(HapticEffect effect)
        {
            if (effect != null)
            {
                effect.Play();
            }
        }

        /// <summary>
        /// Stops an effect without a duration. An effect with a duration plays to its end, so that even a short click
        /// is felt.
        /// </summary>
        private static void End(HapticEffect effect)
        {
            if (effect != null && effect.Duration <= 0f)
            {
                effect.Stop();
            }
        }
    }
}
