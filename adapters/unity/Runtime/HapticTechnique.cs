using System;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>How samples are presented in time.</summary>
    public enum TechniqueKind
    {
        /// <summary>The server's default.</summary>
        Server,

        /// <summary>All samples at the same time.</summary>
        Simultaneous,

        /// <summary>Amplitude modulation.</summary>
        AM,

        /// <summary>Spatiotemporal modulation: one focus visits all samples.</summary>
        STM,

        /// <summary>Lateral modulation: every sample moves to and fro across its normal.</summary>
        LM,
    }

    /// <summary>A technique and its settings.</summary>
    [Serializable]
    public sealed class HapticTechnique
    {
        /// <summary>The kind.</summary>
        public TechniqueKind kind = TechniqueKind.Server;

        /// <summary>AM, STM and LM: the frequency [Hz].</summary>
        [Min(0.1f)] public float frequency = 200f;

        /// <summary>AM: the depth; 1 goes down to silence.</summary>
        [Range(0f, 1f)] public float depth = 1f;

        /// <summary>STM: whether the focus runs around all samples instead of from one to the next.</summary>
        public bool outline;

        /// <summary>LM: the amplitude to either side [m].</summary>
        [Range(0.0001f, 0.02f)] public float amplitude = 0.003f;

        /// <summary>LM: the direction, from the array's x-axis about the normal [deg].</summary>
        public float angle;

        /// <summary>The wire's message; null: the server's default.</summary>
        internal ITechnique Message
        {
            get
            {
                switch (kind)
                {
                    case TechniqueKind.Simultaneous: return new Simultaneous();
                    case TechniqueKind.AM: return new AM { Frequency = frequency, Depth = depth };
                    case TechniqueKind.STM: return new STM { Frequency = frequency, Along = Route() };
                    case TechniqueKind.LM: return new LM { Frequency = frequency, Amplitude = amplitude, Angle = angle };
                    default: return null;
                }
            }
        }

        private IRoute Route()
        {
            return new NamedRoute { Value = outline ? RouteWord.Outline : RouteWord.Samples };
        }
    }
}
