using System;
using System.Text;

namespace Pacinian.Zmtp
{
    /// <summary>
    /// The client's side of the greeting and of the mechanisms NULL and PLAIN, until the peer is ready (RFC 37, "Formal
    /// Grammar", "The NULL Security Mechanism"; RFC 24, "Implementation"). Rejects peers older than ZMTP 3.0.
    /// </summary>
    internal sealed class Handshake
    {
        public const int GreetingBytes = 64;
        private const int VersionAt = 10, MechanismAt = 12, MechanismBytes = 20;

        private readonly ZmtpSettings _settings;
        private readonly byte[] _mechanism;
        private Step _step = Step.Greeting;

        private enum Step
        {
            Greeting,
            Welcome,
            Ready,
            Done,
        }

        public Handshake(ZmtpSettings settings)
        {
            _settings = settings;
            _mechanism = new byte[MechanismBytes];
            string name = settings.User == null ? "NULL" : "PLAIN";
            Encoding.ASCII.GetBytes(name, 0, name.Length, _mechanism, 0);
            Problem = "";
        }

        /// <summary>Whether the peer is ready.</summary>
        public bool Done
        {
            get { return _step == Step.Done; }
        }

        /// <summary>Why there will be no connection; "" if there may be.</summary>
        public string Problem { get; private set; }

        /// <summary>Whether the peer rejected the name and password.</summary>
        public bool Denied { get; private set; }

        /// <summary>The minor number of the peer's version, which is 3.0 or newer.</summary>
        public int Minor { get; private set; }

        /// <summary>Writes the greeting.</summary>
        public void Begin(FrameWriter output)
        {
            byte[] greeting = new byte[GreetingBytes];
            greeting[0] = 0xff;
            greeting[9] = 0x7f;
            greeting[VersionAt] = 3;
            greeting[VersionAt + 1] = 1;
            Buffer.BlockCopy(_mechanism, 0, greeting, MechanismAt, MechanismBytes);
            output.WriteRaw(greeting);
        }

        /// <summary>Handles received bytes. Returns whether the handshake advanced.</summary>
        public bool Advance(FrameReader input, FrameWriter output)
        {
            if (Problem.Length > 0 || Done)
            {
                return false;
            }
            if (_step == Step.Greeting)
            {
                return ReadGreeting(input, output);
            }
            if (!input.Read())
            {
                Problem = input.Problem;
                return false;
            }
            int offset, count;
            if (Command.IsError(input, out offset, out count))
            {
                ReadError(Command.ReadReason(input.Data, offset, count));
            }
            else if (_step == Step.Welcome && Command.Is(input, Command.Welcome, out offset, out count) && count == 0)
            {
                byte[] properties = Properties();
                output.WriteCommand(Command.Initiate, properties, properties.Length);
                _step = Step.Ready;
            }
            else if (_step == Step.Ready && Command.Is(input, Command.Ready, out offset, out count))
            {
                CheckType(Command.FindProperty(input.Data, offset, count, "Socket-Type"));
            }
            else
            {
                Problem = "the peer sent an unexpected frame during the handshake";
            }
            return Problem.Length == 0;
        }

        private bool ReadGreeting(FrameReader input, FrameWriter output)
        {
            int count = Math.Min(input.Waiting, GreetingBytes);
            if (count > 0 && input.Peek(0) != 0xff || count > 9 && (input.Peek(9) & 1) == 0)
            {
                Problem = "this is not ZMTP";
            }
            else if (count > VersionAt && input.Peek(VersionAt) < 3)
            {
                Problem = "the peer speaks a ZMTP older than 3.0";
            }
            for (int i = 0; i < MechanismBytes && MechanismAt + i < count && Problem.Length == 0; i++)
            {
                if (input.Peek(MechanismAt + i) != _mechanism[i])
                {
                    Problem = "the peer wants another mechanism";
                }
            }
            if (Problem.Length > 0 || count < GreetingBytes)
            {
                return false;
            }
            Minor = input.Peek(VersionAt) > 3 ? byte.MaxValue : input.Peek(VersionAt + 1);
            input.Skip(GreetingBytes);
            Introduce(output);
            return true;
        }

        private void Introduce(FrameWriter output)
        {
            if (_settings.User == null)
            {
                byte[] properties = Properties();
                output.WriteCommand(Command.Ready, properties, properties.Length);
                _step = Step.Ready;
                return;
            }
            byte[] user = Encoding.UTF8.GetBytes(_settings.User), password = Encoding.UTF8.GetBytes(_settings.Password);
            byte[] data = new byte[2 + user.Length + password.Length];
            data[0] = (byte)user.Length;
            Buffer.BlockCopy(user, 0, data, 1, user.Length);
            data[1 + user.Length] = (byte)password.Length;
            Buffer.BlockCopy(password, 0, data, 2 + user.Length, password.Length);
            output.WriteCommand(Command.Hello, data, data.Length);
            _step = Step.Welcome;
        }

        private byte[] Properties()
        {
            return _settings.Kind == SocketKind.Sub
                ? Command.WriteProperties("Socket-Type", "SUB")
                : Command.WriteProperties("Socket-Type", "DEALER", "Identity", "");
        }

        /// <summary>
        /// Reads the reason of an ERROR. libzmq gives the status of the server's authenticator (RFC 27): 300, 400 or
        /// 500.
        /// </summary>
        private void ReadError(string reason)
        {
            Denied = reason == "300" || reason == "400" || reason == "500";
            Problem = "the peer refuses: " + reason;
        }

        /// <summary>Checks that the two socket types are compatible (RFC 37, "The Socket-Type Property").</summary>
        private void CheckType(string type)
        {
            bool fits = _settings.Kind == SocketKind.Sub
                ? type == "PUB" || type == "XPUB"
                : type == "ROUTER" || type == "DEALER" || type == "REP";
            _step = fits ? Step.Done : _step;
            if (!fits)
            {
                Problem = type == null
                    ? "the peer's properties are cut off"
                    : "the peer's socket is of type " + Command.MakeVisible(type);
            }
        }
    }
}
