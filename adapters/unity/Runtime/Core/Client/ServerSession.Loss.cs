namespace Pacinian
{
    /// <summary>Decides when the session is lost: its connection has ended, or an answer is late.</summary>
    internal sealed partial class ServerSession
    {
        /// <summary>Why the session is over; "" while it is not.</summary>
        public string Over { get; private set; }

        /// <summary>Whether the session is over because the server rejects the client.</summary>
        public bool Refused { get; private set; }

        /// <summary>Ends the session if its connection has ended. heard: whether messages came in this step.</summary>
        private void CheckConnection(bool heard)
        {
            Ending ending = _transport.Ended();
            string why = _transport.Problem;
            if (Begun && (ending == Ending.Nobody || ending == Ending.Foreign))
            {
                ending = Ending.Gone; // during the handshake of another of its connections
                why = "";
            }
            if (ending != Ending.None && !heard)
            {
                bool refused = ending == Ending.Denied || ending == Ending.Foreign;
                SetLost(ErrorMessages.DescribeEnding(ending, _at, why), refused);
            }
        }

        /// <summary>Ends the session if the server has not answered in time.</summary>
        private void CheckTimeouts(double now)
        {
            double timeout = _shared.Options.Timeout;
            if (!Begun && now - _begun > timeout)
            {
                SetLost(ErrorMessages.Hangs("hello", timeout), false);
                return;
            }
            string late = _unanswered.FindLate(now, timeout);
            if (late.Length > 0)
            {
                SetLost(ErrorMessages.Hangs(late, timeout), false);
            }
        }

        /// <summary>Ends the session, unless it is over. refused: whether the server rejects the client.</summary>
        private void SetLost(string why, bool refused)
        {
            if (Over.Length > 0)
            {
                return;
            }
            Over = why + (Begun ? ErrorMessages.SessionOverSuffix : "");
            Refused = refused;
            _unanswered.Forget(_shared.Inbox);
        }
    }
}
