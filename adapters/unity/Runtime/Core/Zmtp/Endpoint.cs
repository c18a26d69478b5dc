using System.Globalization;
using System.Net;

namespace Pacinian.Zmtp
{
    /// <summary>Parses ZeroMQ's addresses.</summary>
    internal static class Endpoint
    {
        private const string Tcp = "tcp://";

        /// <summary>
        /// Parses `tcp://ADDRESS:PORT`, where ADDRESS is an IP address or `localhost`; returns null if the text is
        /// anything else.
        /// </summary>
        public static IPEndPoint Read(string text)
        {
            int colon = text.LastIndexOf(':');
            int port;
            if (!text.StartsWith(Tcp, System.StringComparison.Ordinal) || colon < Tcp.Length
                || !int.TryParse(text.Substring(colon + 1), NumberStyles.None, CultureInfo.InvariantCulture, out port)
                || port < 1 || port > IPEndPoint.MaxPort)
            {
                return null;
            }
            string host = text.Substring(Tcp.Length, colon - Tcp.Length);
            host = host == "localhost" ? "127.0.0.1" : host;
            bool isV6 = host.StartsWith("[", System.StringComparison.Ordinal) && host.EndsWith("]", System.StringComparison.Ordinal);
            IPAddress address;
            if (!IPAddress.TryParse(isV6 ? host.Substring(1, host.Length - 2) : host, out address)
                || (address.AddressFamily == System.Net.Sockets.AddressFamily.InterNetworkV6) != isV6)
            {
                return null;
            }
            return new IPEndPoint(address, port);
        }
    }
}
