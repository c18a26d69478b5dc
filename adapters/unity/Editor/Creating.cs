using System;
using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>GameObject > Pacinian.</summary>
    internal static class Creating
    {
        [MenuItem("GameObject/Pacinian/Rig (server and array)", false, 10)]
        internal static void Rig(MenuCommand command)
        {
            GameObject rig = Made(command, "Haptic Rig", typeof(HapticServer));
            GameObject array = Made(new MenuCommand(rig), "Array Origin", typeof(ArrayOrigin), typeof(ArrayAlignment));
            array.transform.localPosition = new Vector3(0f, 0.8f, 0.4f);
            Selection.activeObject = rig;
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

        [MenuItem("GameObject/Pacinian/Hand (without a tracker)", false, 13)]
        internal static void Hand(MenuCommand command)
        {
            GameObject hand = Made(command, "Haptic Hand", typeof(OpenHand), typeof(HapticHand));
            hand.GetComponent<HapticHand>().Provider = hand.GetComponent<OpenHand>();
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
