using System;
using UnityEngine;
using UnityEngine.Events;

namespace Pacinian.Haptics
{
    /// <summary>A hand that feels an effect, as the server renders it.</summary>
    public struct HapticTouch
    {
        /// <summary>The effect that is felt.</summary>
        public HapticEffect Effect;

        /// <summary>
        /// The hand: "left" or "right", with a number for further hands of one side ("right 2"). Another client that shares
        /// the scene may have named it otherwise.
        /// </summary>
        public string Hand;

        /// <summary>The middle of the contact, in the world [m].</summary>
        public Vector3 Position;

        /// <summary>The highest requested radiation pressure, at the full level of the envelope [Pa].</summary>
        public float Pressure;

        /// <summary>The pressure relative to the effect's own, 0..1.</summary>
        public float Strength;
    }

    /// <summary>A touch event for the inspector.</summary>
    [Serializable]
    public sealed class HapticTouchEvent : UnityEvent<HapticTouch>
    {
    }
}
