using System;
using Pacinian.Wire;
using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>The menu GameObject > Pacinian.</summary>
    internal static class Creating
    {
        private static readonly string[] Trackers =
        {
            "Pacinian.Haptics.XRHandProvider, Pacinian.Haptics.XRHands",
            "Pacinian.Haptics.LeapHandProvider, Pacinian.Haptics.Ultraleap",
        };

        private const float Apart = 0.08f, High = 0.215f; // [m] of an open hand's palm: beside and above the array's middle

        [MenuItem("GameObject/Pacinian/Array", false, 10)]
        internal static void Array(MenuCommand command)
        {
            Type[] parts = { typeof(ArrayOrigin), typeof(HapticServer), typeof(EmissionView), typeof(HapticStatus) };
            GameObject array = Made(command, "Haptic Array", parts);
            array.transform.localPosition = new Vector3(0f, 0.8f, 0.4f);
        }

        [MenuItem("GameObject/Pacinian/Point", false, 11)]
        internal static void Point(MenuCommand command)
        {
            Made(command, "Haptic Point", typeof(HapticPoint));
        }

        [MenuItem("GameObject/Pacinian/Ball", false, 12)]
        internal static void Ball(MenuCommand command)
        {
            GameObject ball = Made(command, "Haptic Ball", typeof(SphereCollider), typeof(HapticVolume));
            ball.GetComponent<SphereCollider>().radius = 0.03f;
        }

        /// <summary>
        /// Creates both hands, with XR Hands or Ultraleap's plugin if one is installed. With XR Hands they are in the
        /// frame of the camera's parent, which is the XR Origin's offset.
        /// </summary>
        [MenuItem("GameObject/Pacinian/Hands", false, 13)]
        internal static void Hands(MenuCommand command)
        {
            Type tracker = null;
            foreach (string name in Trackers)
            {
                tracker = tracker ?? Type.GetType(name);
            }
            Hands(command, tracker);
            if (tracker == null)
            {
                Debug.LogWarning(
                    "Pacinian: these hands are open, and do not move. For tracked hands, install XR Hands "
                    + "(com.unity.xr.hands) or Ultraleap's plugin (com.ultraleap.tracking) with the Package Manager, then use "
                    + "GameObject > Pacinian > Hands again");
            }
        }

        /// <summary>
        /// tracker: a HandProvider; null: open hands, above the object on which the menu was opened, such as the array.
        /// </summary>
        internal static void Hands(MenuCommand command, Type tracker)
        {
            GameObject hands = Made(command, "Haptic Hands");
            Transform origin = Camera.main == null ? null : Camera.main.transform.parent;
            foreach (HandFrameSide side in new[] { HandFrameSide.Left, HandFrameSide.Right })
            {
                GameObject made = new GameObject(side.ToString(), typeof(HapticHand));
                made.transform.SetParent(hands.transform, false);
                HapticHand hand = made.GetComponent<HapticHand>();
                hand.Side = side;
                if (tracker != null)
                {
                    HandProvider provider = (HandProvider)made.AddComponent(tracker);
                    provider.Follow(side == HandFrameSide.Left, origin);
                    hand.Provider = provider;
                    continue;
                }
                hand.Source = HapticHandSource.Open;
                made.transform.localPosition = new Vector3(side == HandFrameSide.Left ? -Apart : Apart, High, 0f);
            }
        }

        [MenuItem("GameObject/Pacinian/Hand (without a tracker)", false, 13)]
        internal static void Hand(MenuCommand command)
        {
            GameObject hand = Made(command, "Haptic Hand", typeof(HapticHand));
            hand.GetComponent<HapticHand>().Source = HapticHandSource.Open;
        }

        [MenuItem("GameObject/Pacinian/Quiet Zone", false, 14)]
        internal static void Quiet(MenuCommand command)
        {
            Made(command, "Quiet Zone", typeof(QuietZone));
        }

        private static GameObject Made(MenuCommand command, string name, params Type[] components)
        {
            GameObject made = new GameObject(name, components);
            GameObjectUtility.SetParentAndAlign(made, command.context as GameObject);
            Undo.RegisterCreatedObjectUndo(made, "Create " + name);
            Selection.activeObject = made;
            return made;
        }
    }
}
