using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>The client's state, as of the last tick.</summary>
    public sealed partial class HapticClient
    {
        /// <summary>The state of the connection.</summary>
        public ClientStatus Status
        {
            get { return _sessionState.Status; }
        }

        /// <summary>Why there is no session, and what to do; "" if there is one.</summary>
        public string Problem
        {
            get { return _sessionState.Problem; }
        }

        /// <summary>Whether this client has armed the output and owns it.</summary>
        public bool Armed
        {
            get { return _sessionState.Armed && _sessionState.Owner; }
        }

        /// <summary>Whether this client owns the output.</summary>
        public bool Owner
        {
            get { return _sessionState.Owner; }
        }

        /// <summary>The time from the last tick to silence, as granted by the server [s].</summary>
        public double Lease
        {
            get { return _sessionState.Lease; }
        }

        /// <summary>The name of the scene.</summary>
        public string Scene
        {
            get { return _sessionState.Scene; }
        }

        /// <summary>The server's description of itself.</summary>
        public string Server
        {
            get { return _sessionState.Server; }
        }

        /// <summary>The median round trip of the last renewals [s].</summary>
        public double Latency
        {
            get { return _roundTrips.Median; }
        }

        /// <summary>The round trips of the last renewals.</summary>
        public RoundTrips RoundTrips
        {
            get { return _roundTrips; }
        }

        /// <summary>The server's clock minus the client's [s]; the error is at most half of the shortest round trip.</summary>
        public double Offset
        {
            get { return _offset; }
        }

        /// <summary>The server's capabilities; null until it has reported them.</summary>
        public Abilities Capabilities
        {
            get { return _sessionState.Abilities; }
        }

        /// <summary>The newest state, valid until the next tick; null before the first one of this session.</summary>
        public State State
        {
            get { return _shared.Inbox.Read; }
        }

        /// <summary>Returns the achieved and the requested pressure of an object's surface or volume, from the newest state.</summary>
        public RegionFelt Felt(string name)
        {
            return RegionFelt.Of(State, name);
        }

        /// <summary>Why the output is silent, and what to do, from the newest state; "" while it sounds.</summary>
        public Silence Silence
        {
            get { return Silence.Of(_sessionState, State); }
        }

        /// <summary>The hands that now feel an object of this client's scene.</summary>
        public IReadOnlyList<HandTouch> Touches
        {
            get { return _touches.Now; }
        }

        /// <summary>The client's monotonic clock [s].</summary>
        public double Now
        {
            get { return _shared.Options.Clock(); }
        }

        /// <summary>Returns the time since the server published a state [s].</summary>
        public double Age(State state)
        {
            return Now + _offset - state.Time;
        }
    }
}
