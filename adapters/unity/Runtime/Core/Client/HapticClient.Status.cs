using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>How it stands, as of the last tick.</summary>
    public sealed partial class HapticClient
    {
        /// <summary>How it stands with the server.</summary>
        public ClientStatus Status
        {
            get { return _standing.Status; }
        }

        /// <summary>Why there is no session, and what to do; "" if there is one.</summary>
        public string Problem
        {
            get { return _standing.Problem; }
        }

        /// <summary>Whether this client's scene may be felt.</summary>
        public bool Armed
        {
            get { return _standing.Armed && _standing.Owner; }
        }

        /// <summary>Whether this client owns the output.</summary>
        public bool Owner
        {
            get { return _standing.Owner; }
        }

        /// <summary>From the last tick to silence, as agreed with the server [s].</summary>
        public double Lease
        {
            get { return _standing.Lease; }
        }

        /// <summary>The name of the scene.</summary>
        public string Scene
        {
            get { return _standing.Scene; }
        }

        /// <summary>What the server says that it is.</summary>
        public string Server
        {
            get { return _standing.Server; }
        }

        /// <summary>Median round trip of the last renewals [s].</summary>
        public double Latency
        {
            get { return _trips.Median; }
        }

        /// <summary>Round trips of the last renewals.</summary>
        public Trips Trips
        {
            get { return _trips; }
        }

        /// <summary>Server's clock less ours [s]; right to half of the shortest round trip.</summary>
        public double Offset
        {
            get { return _offset; }
        }

        /// <summary>What the server can do; null until it has told.</summary>
        public Abilities Capabilities
        {
            get { return _standing.Abilities; }
        }

        /// <summary>The newest state, good until the next tick; null before the first of this session.</summary>
        public State State
        {
            get { return _shared.Inbox.Read; }
        }

        /// <summary>What is felt of an object's surface or volume, by its name, in the newest state.</summary>
        public RegionFelt Felt(string name)
        {
            return RegionFelt.Of(State, name);
        }

        /// <summary>Why the output is silent, and what to do; "" while it sounds. As of the newest state.</summary>
        public Silence Silence
        {
            get { return Silence.Of(_standing, State); }
        }

        /// <summary>Hands that feel an object of this client's scene now.</summary>
        public IReadOnlyList<HandTouch> Touches
        {
            get { return _touches.Now; }
        }

        /// <summary>Our steady clock [s].</summary>
        public double Now
        {
            get { return _shared.Options.Clock(); }
        }

        /// <summary>How long ago the server published a state [s].</summary>
        public double Age(State state)
        {
            return Now + _offset - state.Time;
        }
    }
}
