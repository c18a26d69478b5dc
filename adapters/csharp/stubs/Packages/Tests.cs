using NUnit.Framework;
using UnityEngine;
using UnityEngine.XR.Interaction.Toolkit;
#if PACINIAN_XRI_3
using Leap;
using UnityEngine.XR.Interaction.Toolkit.Interactables;
#else
using Leap;
using Leap.Unity;
#endif

namespace Pacinian.Haptics.Tests
{
    /// <summary>Tests the components for other packages, with stubs of these packages.</summary>
    public sealed class PackagesTests
    {
        private GameObject _owner;

        [SetUp]
        public void Stand()
        {
            _owner = new GameObject("owner");
        }

        [TearDown]
        public void Clean()
        {
            Object.DestroyImmediate(_owner);
        }

        [Test]
        public void EffectsPlayWhileAnInteractableIsHoveredOverOrSelected()
        {
            HapticAffordance affordance = _owner.AddComponent<HapticAffordance>();
            XRBaseInteractable thing = _owner.GetComponent<XRBaseInteractable>();
            affordance.WhileHovered = Effect("hum", 0f);
            affordance.WhileSelected = Effect("click", 0.1f);
            thing.isHovered = true;
            thing.hoverEntered.Invoke(new HoverEnterEventArgs());
            Assert.IsTrue(affordance.WhileHovered.Playing);
            Assert.IsFalse(affordance.WhileSelected.Playing);
            thing.selectEntered.Invoke(new SelectEnterEventArgs());
            thing.selectExited.Invoke(new SelectExitEventArgs());
            Assert.IsTrue(affordance.WhileSelected.Playing, "until its duration is over");
            thing.hoverExited.Invoke(new HoverExitEventArgs());
            Assert.IsTrue(affordance.WhileHovered.Playing, "the other hand is there still");
            thing.isHovered = false;
            thing.hoverExited.Invoke(new HoverExitEventArgs());
            Assert.IsFalse(affordance.WhileHovered.Playing);
            affordance.enabled = false;
            thing.hoverEntered.Invoke(new HoverEnterEventArgs());
            Assert.IsFalse(affordance.WhileHovered.Playing);
        }

        [Test]
        public void AHandOfUltraleapIsTheOneOfItsSide()
        {
            HapticHand hand = _owner.AddComponent<HapticHand>();
            LeapHandProvider provider = _owner.AddComponent<LeapHandProvider>();
            provider.Follow(true, null);
            hand.Frame(Rigid.Identity, 0.0);
            Assert.IsFalse(hand.Tracked, "there is no tracker");
            Tracker tracker = _owner.AddComponent<Tracker>();
            Hands.Provider = tracker;
            tracker.Now.Hands.Add(new Hand { IsLeft = false });
            for (int i = 0; i < 60; i++)
            {
                hand.Frame(Rigid.Identity, 0.0);
            }
            Assert.IsFalse(hand.Tracked, "only a right hand is there");
            Hand left = new Hand { IsLeft = true };
            left.Arm.NextJoint = new Vector3(1f, 2f, 3f);
#if PACINIAN_XRI_3
            Finger index = left.fingers[1];
#else
            Finger index = left.Fingers[1];
#endif
            index.bones[3].NextJoint = new Vector3(4f, 5f, 6f);
            index.bones[3].Width = 0.016f;
            tracker.Now.Hands.Add(left);
            Wire.HandFrame frame = hand.Frame(Rigid.Identity, 0.0);
            Assert.IsTrue(hand.Tracked);
            Assert.AreEqual(2.0, hand.Joint(1).y, 1e-6, "the wrist");
            Assert.AreEqual(5.0, hand.Joint(10).y, 1e-6, "the tip of the index finger");
            Assert.AreEqual(26, frame.Joints.Numbers / 3);
        }

        private HapticEffect Effect(string name, float duration)
        {
            GameObject made = new GameObject(name);
            made.transform.SetParent(_owner.transform, false);
            HapticPoint point = made.AddComponent<HapticPoint>();
            point.Stop();
            point.Duration = duration;
            return point;
        }

        private sealed class Tracker : LeapProvider
        {
            public readonly Frame Now = new Frame();

            public override Frame CurrentFrame
            {
                get { return Now; }
            }
        }
    }
}
