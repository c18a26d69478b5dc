using System;
using System.IO;
using System.Net;
using System.Net.Sockets;
using System.Security.Cryptography;
using System.Text;

namespace Pacinian
{
    /// <summary>
    /// Sends an emergency stop to a server on this machine as a datagram. It needs no connection, so other clients cannot
    /// block it. An HMAC in both datagrams proves that the sender has the secret of the connection file.
    /// </summary>
    internal static class StopDatagram
    {
        private const double Resend = 0.1; // [s] after which an unconfirmed datagram is sent again
        private const int NonceBytes = 16;

        /// <summary>
        /// Returns whether the server has confirmed the stop in time. address: `stop` of the connection file. secret: its
        /// token, or its secret key. timeout: [s]. clock: [s].
        /// </summary>
        public static bool Request(string address, string secret, double timeout, Func<double> clock)
        {
            byte[] nonce = new byte[NonceBytes];
            using (RandomNumberGenerator random = RandomNumberGenerator.Create())
            {
                random.GetBytes(nonce);
            }
            byte[] asked = Sign(secret, "stop", nonce), confirmed = Sign(secret, "stopped", nonce);
            string own = "";
            try
            {
                using (Socket socket = Connect(address, nonce, ref own))
                {
                    double end = clock() + timeout;
                    for (double left = timeout; left > 0.0; left = end - clock())
                    {
                        socket.ReceiveTimeout = (int)Math.Ceiling(1e3 * Math.Min(left, Resend));
                        socket.Send(asked);
                        if (Receives(socket, confirmed))
                        {
                            return true;
                        }
                    }
                }
            }
            catch (Exception error) when (error is SocketException || error is IOException || error is ArgumentException
                || error is FormatException || error is OverflowException || error is NotSupportedException
                || error is UnauthorizedAccessException)
            {
                // no such sockets here, or no such server
            }
            finally
            {
                Remove(own);
            }
            return false;
        }

        /// <summary>Returns a connected socket that can receive an answer. own: its file, if it has one.</summary>
        private static Socket Connect(string address, byte[] nonce, ref string own)
        {
            int colon = address.IndexOf(':');
            string kind = address.Substring(0, Math.Max(colon, 0)), at = address.Substring(colon + 1);
            bool local = kind == "unix";
            AddressFamily family = local ? AddressFamily.Unix : AddressFamily.InterNetwork;
            Socket made = new Socket(family, SocketType.Dgram, local ? ProtocolType.Unspecified : ProtocolType.Udp);
            try
            {
                if (local)
                {
                    string name = at + "-" + BitConverter.ToUInt32(nonce, 0).ToString("x8"); // paths have 100 bytes at most
                    made.Bind(new UnixEndPoint(name));
                    own = name;
                    made.Connect(new UnixEndPoint(at));
                }
                else
                {
                    made.Connect(new IPEndPoint(IPAddress.Loopback, int.Parse(at, System.Globalization.CultureInfo.InvariantCulture)));
                }
                return made;
            }
            catch
            {
                made.Dispose();
                throw;
            }
        }

        private static bool Receives(Socket socket, byte[] wanted)
        {
            byte[] data = new byte[wanted.Length + 1];
            try
            {
                int count = socket.Receive(data);
                int different = count ^ wanted.Length;
                for (int i = 0; i < wanted.Length; i++)
                {
                    different |= data[i] ^ wanted[i];
                }
                return different == 0;
            }
            catch (SocketException error) when (error.SocketErrorCode == SocketError.TimedOut
                || error.SocketErrorCode == SocketError.WouldBlock)
            {
                return false;
            }
        }

        private static byte[] Sign(string secret, string what, byte[] nonce)
        {
            byte[] text = Encoding.ASCII.GetBytes(what), made = new byte[NonceBytes + 32];
            byte[] signed = new byte[text.Length + NonceBytes];
            text.CopyTo(signed, 0);
            nonce.CopyTo(signed, text.Length);
            nonce.CopyTo(made, 0);
            using (HMACSHA256 hmac = new HMACSHA256(Encoding.UTF8.GetBytes(secret)))
            {
                hmac.ComputeHash(signed).CopyTo(made, NonceBytes);
            }
            return made;
        }

        private static void Remove(string file)
        {
            try
            {
                if (file.Length > 0)
                {
                    File.Delete(file);
                }
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException)
            {
                // the server removes its folder at its end
            }
        }

        /// <summary>The path of a Unix socket. The class of .NET with this purpose is missing in older versions.</summary>
        private sealed class UnixEndPoint : EndPoint
        {
            private readonly byte[] _path;

            public UnixEndPoint(string path)
            {
                _path = Encoding.UTF8.GetBytes(path);
            }

            public override AddressFamily AddressFamily
            {
                get { return AddressFamily.Unix; }
            }

            public override SocketAddress Serialize()
            {
                SocketAddress made = new SocketAddress(AddressFamily.Unix, 2 + _path.Length + 1);
                for (int i = 0; i < _path.Length; i++)
                {
                    made[2 + i] = _path[i];
                }
                made[2 + _path.Length] = 0;
                return made;
            }

            public override EndPoint Create(SocketAddress address)
            {
                return new UnixEndPoint("");
            }
        }
    }
}
