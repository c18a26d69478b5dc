using System;
using Pacinian.Wire;
using UnityEditor;
using UnityEngine;
using UnityEngine.SceneManagement;

namespace Pacinian.Haptics.Editing
{
    /// <summary>The menu GameObject > Pacinian.</summary>
    internal static class GameObjectMenu
    {
        private static readonly string[] Trackers =
        {
            "Pacinian.Haptics.XRHandProvider, Pacinian.Haptics.XRHands",
            "Pacinian.Haptics.LeapHandProvider, Pacinian.Haptics.Ultraleap",
        };

        private const float BallHeight = 0.175f, HandHeight = 0.215f; // [m] above the array's middle

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

        /// <summary>
        /// Creates a ball; if the menu was opened on the array or on nothing, above the array.
        /// </summary>
        [MenuItem("GameObject/Pacinian/Ball", false, 12)]
        internal static void Ball(MenuCommand command)
        {
            GameObject ball = Made(command, "Haptic Ball", typeof(SphereCollider), typeof(HapticVolume));
            ball.GetComponent<SphereCollider>().radius = 0.03f;
            ArrayOrigin array = FindArray(command);
            if (array != null)
            {
                Place(ball, array.transform, BallHeight);
            }
        }

        /// <summary>
        /// Creates both hands, if XR Hands or Ultraleap's plugin is installed, and a hand that the mouse moves. With XR
        /// Hands the hands are in the frame of the camera's parent, which is the XR Origin's offset.
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
                    "Pacinian: no tracker is installed, so there is only a hand for the mouse: hold the left button in the "
                    + "game. For tracked hands, install XR Hands (com.unity.xr.hands) or Ultraleap's plugin "
                    + "(com.ultraleap.tracking) with the Package Manager, then use GameObject > Pacinian > Hands again");
            }
        }

        /// <summary>
        /// tracker: a HandProvider, or null. The mouse's hand is above the object on which the menu was opened, such as the
        /// array; if there is none, above the array of the scene.
        /// </summary>
        internal static void Hands(MenuCommand command, Type tracker)
        {
            GameObject hands = Made(command, "Haptic Hands");
            Transform origin = Camera.main == null ? null : Camera.main.transform.parent;
            foreach (HandFrameSide side in new[] { HandFrameSide.Left, HandFrameSide.Right })
            {
                if (tracker != null)
                {
                    HapticHand hand = Hand(hands, side.ToString(), side);
                    hand.Provider = (HandProvider)hand.gameObject.AddComponent(tracker);
                    hand.Provider.Follow(side == HandFrameSide.Left, origin);
                }
            }
            HapticHand test = Hand(hands, "Mouse", HandFrameSide.Right);
            test.Source = HapticHandSource.Mouse;
            ArrayOrigin array = FindArray(command);
            Place(test.gameObject, array == null ? hands.transform : array.transform, HandHeight);
        }

        private static HapticHand Hand(GameObject parent, string name, HandFrameSide side)
        {
            GameObject made = new GameObject(name, typeof(HapticHand));
            made.transform.SetParent(parent.transform, false);
            HapticHand hand = made.GetComponent<HapticHand>();
            hand.Side = side;
            return hand;
        }

        private static void Place(GameObject made, Transform below, float height)
        {
            made.transform.position = below.TransformPoint(new Vector3(0f, height, 0f));
            made.transform.rotation = below.rotation;
        }

        /// <summary>
        /// Returns the array on which the menu was opened; if it was opened on nothing, the first of the scene. null: none.
        /// </summary>
        private static ArrayOrigin FindArray(MenuCommand command)
        {
            GameObject context = command.context as GameObject;
            if (context != null)
            {
                return context.GetComponent<ArrayOrigin>();
            }
            foreach (GameObject root in SceneManager.GetActiveScene().GetRootGameObjects())
            {
                foreach (ArrayOrigin found in root.GetComponentsInChildren<ArrayOrigin>())
                {
                    return found;
                }
            }
            return null;
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
