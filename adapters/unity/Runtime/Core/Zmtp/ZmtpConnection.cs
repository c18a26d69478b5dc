using System;

namespace Pacinian.Zmtp
{
    /// <summary>
    /// The protocol of one connection, from the greeting to its end: handshake, messages, subscriptions, heartbeats
    /// (RFC 37). Never blocks, and does no input or output: bytes and times [s] are arguments. Take a time before
    /// reading the bytes that belong to it. Otherwise a program that stood still takes its own pause for silence of the
    /// peer.
    /// </summary>
    internal sealed class ZmtpConnection
    {
        private const int MaxFrames = 64; // waiting frames beyond which heartbeats are not answered
        private const int MaxContext = 16; // [bytes] of a heartbeat
        private const int MinorOfCommands = 1; // from ZMTP 3.1 on, subscriptions and heartbeats are commands
        private const double TtlUnit = 0.1; // [s]

        private readonly ZmtpSettings _settings;
        private readonly Handshake _handshake;
        private readonly byte[] _ping = new byte[2], _context = new byte[MaxContext];
        private readonly double _begun;
        private double _heard, _pinged, _unanswered = double.NaN, _peerTimeout;
        private bool _inMessage, _wanted, _failed;

        /// <summary>Starts with the greeting.</summary>
        public ZmtpConnection(ZmtpSettings settings, double now)
        {
            _settings = settings;
            _handshake = new Handshake(settings);
            _begun = _heard = _pinged = now;
            int ticks = (int)Math.Round(settings.PingTimeout / TtlUnit);
            _ping[0] = (byte)(ticks >> 8);
            _ping[1] = (byte)ticks;
            Input = new FrameReader(settings.MaxMessage, Command.MaxBytes);
            Output = new FrameWriter();
            Problem = "";
            _handshake.Begin(Output);
        }

        /// <summary>Receives the peer's bytes.</summary>
        public FrameReader Input { get; private set; }

        /// <summary>The bytes to be sent to the peer.</summary>
        public FrameWriter Output { get; private set; }

        /// <summary>Whether messages can be sent.</summary>
        public bool Established { get; private set; }

        /// <summary>How the connection has ended; close it then.</summary>
        public Ending Ending { get; private set; }

        /// <summary>Why the connection has ended, for people; "" if the peer has closed it, or if it has not ended.</summary>
        public string Problem { get; private set; }

        /// <summary>Whether a message can be sent now.</summary>
        public bool HasRoom
        {
            get { return Established && Ending == Ending.None && Output.Frames < _settings.SendLimit; }
        }

        /// <summary>Records that bytes were added to <see cref="Input"/> which had arrived at that time.</summary>
        public void NoteArrival(double now)
        {
            _heard = now;
            _unanswered = double.NaN;
            _peerTimeout = 0.0;
        }

        /// <summary>Continues the handshake; call it when bytes have arrived.</summary>
        public void Advance()
        {
            if (Established || Ending != Ending.None)
            {
                return;
            }
            while (_handshake.Advance(Input, Output))
            {
            }
            if (_handshake.Problem.Length > 0)
            {
                End(_handshake.Denied ? Ending.Denied : Ending.Foreign, _handshake.Problem);
                return;
            }
            Established = _handshake.Done;
            for (int i = 0; i < _settings.Topics.Count && Established; i++)
            {
                Subscribe(_settings.Topics[i]);
            }
        }

        /// <summary>
        /// Reads the last part of the next message; drops the parts before it. Copies as many bytes as there is room
        /// for. Returns the part's length; -1 if no message is complete.
        /// </summary>
        public int Read(byte[] into)
        {
            Advance();
            while (Established && !_failed && Input.Read())
            {
                _peerTimeout = 0.0; // a heartbeat limits only the silence that follows it
                if (Input.IsCommand)
                {
                    HandleCommand();
                    continue;
                }
                _wanted = _inMessage ? _wanted : _settings.IsWanted(Input.Data, Input.Offset, Input.Count);
                _inMessage = Input.HasMore;
                if (!_inMessage && _wanted)
                {
                    int count = Math.Min(Input.Count, into.Length);
                    Buffer.BlockCopy(Input.Data, Input.Offset, into, 0, count);
                    return count;
                }
            }
            if (Input.Problem.Length > 0)
            {
                Fail(Ending.Foreign, Input.Problem);
            }
            return -1;
        }

        /// <summary>Takes a message of one part. Returns false if there is no room.</summary>
        public bool Send(byte[] data, int count)
        {
            if (!HasRoom)
            {
                return false;
            }
            Output.WriteMessage(data, count);
            return true;
        }

        /// <summary>
        /// Sends a heartbeat that is due, and ends a connection that was silent for too long (RFC 37, "Connection
        /// Heartbeating"). ZMTP 3.0 has no heartbeats, so its peers are sent none.
        /// </summary>
        public void CheckTime(double now)
        {
            if (!Established)
            {
                if (now - _begun > _settings.HandshakeTimeout)
                {
                    End(Ending.Foreign, "the handshake takes too long");
                }
                return;
            }
            if (_settings.PingInterval > 0.0 && _handshake.Minor >= MinorOfCommands && now - _pinged >= _settings.PingInterval)
            {
                _pinged = now;
                _unanswered = double.IsNaN(_unanswered) ? now : _unanswered;
                if (Output.Count == 0) // otherwise heartbeats would pile up
                {
                    Output.WriteCommand(Command.Ping, _ping, _ping.Length);
                }
            }
            if (now - _unanswered > _settings.PingTimeout || _peerTimeout > 0.0 && now - _heard > _peerTimeout)
            {
                End(Ending.Gone, "the peer is silent");
            }
        }

        /// <summary>Records that the peer has closed the connection.</summary>
        public void NoteClosed()
        {
            End(Established ? Ending.Gone : Ending.Foreign, "");
        }

        /// <summary>
        /// Subscribes to messages with this prefix: by a command (RFC 37, "The Publish-Subscribe Pattern"), or for a peer
        /// of ZMTP 3.0 by a message (RFC 23, the same).
        /// </summary>
        private void Subscribe(byte[] topic)
        {
            if (_handshake.Minor >= MinorOfCommands)
            {
                Output.WriteCommand(Command.Subscribe, topic, topic.Length);
                return;
            }
            byte[] message = new byte[1 + topic.Length];
            message[0] = 1;
            Buffer.BlockCopy(topic, 0, message, 1, topic.Length);
            Output.WriteMessage(message, message.Length);
        }

        private void HandleCommand()
        {
            int offset, count;
            if (Command.Is(Input, Command.Ping, out offset, out count))
            {
                int context = count - _ping.Length;
                if (context < 0 || context > MaxContext)
                {
                    Fail(Ending.Foreign, "the peer sent a heartbeat of " + count + " bytes, not "
                        + _ping.Length + " to " + (_ping.Length + MaxContext));
                    return;
                }
                _peerTimeout = TtlUnit * (Input.Data[offset] << 8 | Input.Data[offset + 1]);
                if (Output.Frames < MaxFrames)
                {
                    Buffer.BlockCopy(Input.Data, offset + _ping.Length, _context, 0, context);
                    Output.WriteCommand(Command.Pong, _context, context);
                }
            }
            else if (Command.Is(Input, Command.Error, out offset, out count))
            {
                Fail(Ending.Gone, "the peer closes the connection: " + Command.ReadReason(Input.Data, offset, count));
            }
        }

        /// <summary>Ends the connection; later bytes are not read (RFC 37, "Error Handling").</summary>
        private void Fail(Ending ending, string problem)
        {
            _failed = true;
            End(ending, problem);
        }

        private void End(Ending ending, string problem)
        {
            if (Ending == Ending.None)
            {
                Ending = ending;
                Problem = problem;
            }
        }
    }
}
