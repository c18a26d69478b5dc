using System;

namespace Pacinian.Zmtp
{
    /// <summary>
    /// What is said on one connection, from the greeting to its end: handshake, messages, subscriptions, heartbeats (RFC 37).
    /// Pure: bytes and times [s] are given, and it never waits. A time is to be taken before the bytes are read that go with
    /// it, so that a program that stood still does not take that for the peer's silence.
    /// </summary>
    internal sealed class ZmtpConnection
    {
        private const int MaxFrames = 64; // that wait to be sent before heartbeats are not answered any more
        private const int MaxContext = 16; // [bytes] of a heartbeat
        private const int MinorOfCommands = 1; // from ZMTP 3.1 on, subscriptions and heartbeats are commands
        private const double TtlUnit = 0.1; // [s]

        private readonly ZmtpSettings _settings;
        private readonly Handshake _handshake;
        private readonly byte[] _ping = new byte[2], _context = new byte[MaxContext];
        private readonly double _begun;
        private double _heard, _pinged, _unanswered = double.NaN, _peerTimeout;
        private bool _inMessage, _wanted, _failed;

        /// <summary>Begins with the greeting.</summary>
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

        /// <summary>Where the peer's bytes go.</summary>
        public FrameReader Input { get; private set; }

        /// <summary>What is to be sent to the peer.</summary>
        public FrameWriter Output { get; private set; }

        /// <summary>Whether messages can be sent.</summary>
        public bool Established { get; private set; }

        /// <summary>How it has ended; it is to be closed then.</summary>
        public Ending Ending { get; private set; }

        /// <summary>Why it has ended, for people; "" if the peer has closed it, or it has not ended.</summary>
        public string Problem { get; private set; }

        /// <summary>Whether a message can be sent now.</summary>
        public bool HasRoom
        {
            get { return Established && Ending == Ending.None && Output.Frames < _settings.SendLimit; }
        }

        /// <summary>Bytes were added to <see cref="Input"/>, which were there at that time.</summary>
        public void NoteArrival(double now)
        {
            _heard = now;
            _unanswered = double.NaN;
            _peerTimeout = 0.0;
        }

        /// <summary>Goes on with the handshake; to be called when bytes have come.</summary>
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
                Subscribe(_settings.Topics[i], true);
            }
        }

        /// <summary>
        /// Reads the last part of the next message: how many bytes it is, of which as many are copied as there is room for;
        /// -1 if none has come whole. Parts before it are not kept.
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

        /// <summary>Takes a message of one part; false if there is no room for it.</summary>
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
        /// Asks for messages that begin so, or not any more: by a command (RFC 37, "The Publish-Subscribe Pattern"), or to a peer of
        /// ZMTP 3.0 by a message (RFC 23, the same).
        /// </summary>
        public void Subscribe(byte[] topic, bool wanted)
        {
            if (_handshake.Minor >= MinorOfCommands)
            {
                Output.WriteCommand(wanted ? Command.Subscribe : Command.Cancel, topic, topic.Length);
                return;
            }
            byte[] message = new byte[1 + topic.Length];
            message[0] = (byte)(wanted ? 1 : 0);
            Buffer.BlockCopy(topic, 0, message, 1, topic.Length);
            Output.WriteMessage(message, message.Length);
        }

        /// <summary>
        /// Sends a heartbeat that is due, and ends what was silent for too long (RFC 37, "Connection Heartbeating"). ZMTP 3.0 has no
        /// heartbeats: its peers are sent none.
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
                if (Output.Count == 0) // else it would be one more that waits
                {
                    Output.WriteCommand(Command.Ping, _ping, _ping.Length);
                }
            }
            if (now - _unanswered > _settings.PingTimeout || _peerTimeout > 0.0 && now - _heard > _peerTimeout)
            {
                End(Ending.Gone, "the peer is silent");
            }
        }

        /// <summary>The peer has closed the connection.</summary>
        public void NoteClosed()
        {
            End(Established ? Ending.Gone : Ending.Foreign, "");
        }

        private void HandleCommand()
        {
            int offset, count;
            if (Command.Is(Input, Command.Ping, out offset, out count))
            {
                int context = count - _ping.Length;
                if (context < 0 || context > MaxContext)
                {
                    Fail(Ending.Foreign, "a heartbeat of " + count + " bytes");
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
                Fail(Ending.Gone, "the peer ends it: " + Command.ReadReason(Input.Data, offset, count));
            }
        }

        /// <summary>What comes after it is not read (RFC 37, "Error Handling").</summary>
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
