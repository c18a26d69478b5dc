using System;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>How samples are presented in time.</summary>
    public enum TechniqueKind
    {
        /// <summary>As the server is set.</summary>
        Server,

        /// <summary>All at once, always.</summary>
        Simultaneous,

        /// <summary>Amplitude modulation.</summary>
        AM,

        /// <summary>A single focus runs along all of them.</summary>
        STM,

        /// <summary>Every sample moves to and fro across its normal.</summary>
        LM,
    }

    /// <summary>A technique and its settings.</summary>
    [Serializable]
    public sealed class HapticTechnique
    {
        /// <summary>Which it is.</summary>
        public TechniqueKind kind = TechniqueKind.Server;

        /// <summary>Of AM, STM and LM [Hz].</summary>
        [Min(0.1f)] public float frequency = 200f;

        /// <summary>Of AM: 1 goes down to nothing.</summary>
        [Range(0f, 1f)] public float depth = 1f;

        /// <summary>Of STM: around all samples, not from one to the next.</summary>
        public bool outline;

        /// <summary>Of LM: to either side [m].</summary>
        [Range(0.0001f, 0.02f)] public float amplitude = 0.003f;

        /// <summary>Of LM: from the array's x-axis, about the normal [deg].</summary>
        public float angle;

        /// <summary>As the wire has it; null: the server's.</summary>
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
