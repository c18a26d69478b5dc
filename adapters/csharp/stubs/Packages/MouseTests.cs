using NUnit.Framework;
using UnityEngine;
#if ENABLE_INPUT_SYSTEM
using UnityEngine.InputSystem;
#endif

namespace Pacinian.Haptics.Tests
{
    /// <summary>Tests the hand that the mouse moves, with stubs of either of Unity's input systems.</summary>
    public sealed class MouseTests
    {
        private GameObject _owner;
        private HapticHand _hand;

        [SetUp]
        public void Stand()
        {
            _owner = new GameObject("hand");
            _owner.transform.position = new Vector3(1f, 2f, 3f);
            _hand = _owner.AddComponent<HapticHand>();
            _hand.Source = HapticHandSource.Mouse;
            _hand.MouseReach = 0.2f;
        }

        [TearDown]
        public void Clean()
        {
            Move(Vector2.zero, false);
            Object.DestroyImmediate(_owner);
        }

        [Test]
        public void TheHandIsThereWhileTheButtonIsDown()
        {
            Move(new Vector2(0.5f, 0.5f), false);
            _hand.Frame(Rigid.Identity, 0.0);
            Assert.IsFalse(_hand.Tracked);
            Move(new Vector2(0.5f, 0.5f), true);
            IsAt(1.0, 2.0, 3.0);
        }

        [Test]
        public void TheMouseMovesTheHandToBothSidesAndForwardAndBack()
        {
            Move(new Vector2(1f, 0.5f), true);
            IsAt(1.2, 2.0, 3.0);
            Move(new Vector2(0.5f, 0f), true);
            IsAt(1.0, 2.0, 2.8);
            _owner.transform.rotation = Quaternion.AngleAxis(90f, Vector3.up);
            IsAt(0.8, 2.0, 3.0);
        }

        [Test]
        public void BeyondTheWindowTheHandStaysInReach()
        {
            Move(new Vector2(-5f, 9f), true);
            IsAt(0.8, 2.0, 3.2);
        }

        private void IsAt(double x, double y, double z)
        {
            _hand.Frame(Rigid.Identity, 0.0);
            Assert.IsTrue(_hand.Tracked);
            Vector3 palm = _hand.Joint(0);
            Assert.AreEqual(x, palm.x, 1e-4);
            Assert.AreEqual(y, palm.y, 1e-4);
            Assert.AreEqual(z, palm.z, 1e-4);
        }

        /// <summary>place: of the mouse, from (0, 0) at the window's lower left to (1, 1) at its upper right.</summary>
        private static void Move(Vector2 place, bool held)
        {
            Vector2 pixels = new Vector2(place.x * Screen.width, place.y * Screen.height);
#if ENABLE_INPUT_SYSTEM
            Mouse.current = Mouse.current ?? new Mouse();
            Mouse.current.position.Given = pixels;
            Mouse.current.leftButton.isPressed = held;
#else
            Input.Given = new Vector3(pixels.x, pixels.y, 0f);
            Input.Held = held;
#endif
        }
    }
}
