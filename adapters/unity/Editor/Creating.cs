using System;
using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>GameObject > Pacinian.</summary>
    internal static class Creating
    {
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
