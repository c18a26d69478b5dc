using System;
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.XR.Hands;

namespace Pacinian.Haptics
{
    /// <summary>A hand of Unity's XR Hands package (com.unity.xr.hands), from OpenXR's hand tracking.</summary>
    [AddComponentMenu("Pacinian/XR Hand")]
    public sealed class XRHandProvider : HandProvider
    {
        [SerializeField, Tooltip("Whether this is the left hand.")] private bool left;
        [SerializeField, Tooltip("The XR Origin's camera offset, in whose frame joints are reported. Empty: the world.")]
        private Transform origin;

        private static readonly Predicate<XRHandSubsystem> s_runs = Runs; // created once

        private readonly List<XRHandSubsystem> _found = new List<XRHandSubsystem>();
        private XRHandSubsystem _subsystem;

        /// <inheritdoc/>
        public override bool TryGet(Vector3[] positions, float[] radii)
        {
            if (!Running())
            {
                return false;
            }
            XRHand hand = left ? _subsystem.leftHand : _subsystem.rightHand;
            for (int i = 0; i < HapticHand.Count && hand.isTracked; i++)
            {
                XRHandJoint joint = hand.GetJoint(Id(i));
                Pose pose;
                if (!joint.TryGetPose(out pose))
                {
                    return false;
                }
                positions[i] = origin == null ? pose.position : origin.TransformPoint(pose.position);
                float radius;
                radii[i] = joint.TryGetRadius(out radius) ? radius : 0f;
            }
            return hand.isTracked;
        }

        /// <inheritdoc/>
        public override void Follow(bool left, Transform origin)
        {
            this.left = left;
            this.origin = origin;
        }

        /// <summary>
        /// Returns the joint's ID. OpenXR begins with the palm, the package with the wrist; the rest is in the same
        /// order.
        /// </summary>
        private static XRHandJointID Id(int index)
        {
            return index == 0 ? XRHandJointID.Palm : index == 1 ? XRHandJointID.Wrist : (XRHandJointID)(index + 1);
        }

        private bool Running()
        {
            if (_subsystem != null && _subsystem.running)
            {
                return true;
            }
            SubsystemManager.GetSubsystems(_found);
            _subsystem = _found.Find(s_runs);
            return _subsystem != null;
        }

        private static bool Runs(XRHandSubsystem subsystem)
        {
            return subsystem.running;
        }
    }
}
