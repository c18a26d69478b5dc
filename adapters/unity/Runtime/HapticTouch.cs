using System;
using UnityEngine;
using UnityEngine.Events;

namespace Pacinian.Haptics
{
    /// <summary>A hand that feels an effect, as the server renders it.</summary>
    public struct HapticTouch
    {
        /// <summary>What it feels.</summary>
        public HapticEffect Effect;

        /// <summary>Which hand: "left" or "right", unless another program that shares the scene has named it.</summary>
        public string Hand;

        /// <summary>Middle of what is pressed on, in the world [m].</summary>
        public Vector3 Position;

        /// <summary>Highest radiation pressure that is asked for, at full envelope [Pa].</summary>
        public float Pressure;

        /// <summary>That pressure over the effect's own, 0..1.</summary>
        public float Strength;
    }

    /// <summary>A touch, to be connected in the inspector.</summary>
    [Serializable]
    public sealed class HapticTouchEvent : UnityEvent<HapticTouch>
    {
    }
}
