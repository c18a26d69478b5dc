using System;
using System.Threading;

namespace Pacinian.Tests
{
    /// <summary>Loads and unloads a domain with a connected client twice, as an editor does. Argument: connection file.</summary>
    public sealed class ClientDomain : MarshalByRefObject
    {
        private HapticClient _client;

        private static void Main(string[] arguments)
        {
            for (int i = 0; i < 2; i++)
            {
                AppDomain domain = AppDomain.CreateDomain("play" + i);
                Type type = typeof(ClientDomain);
                ((ClientDomain)domain.CreateInstanceAndUnwrap(type.Assembly.FullName, type.FullName)).Play(arguments[0]);
                Console.Out.WriteLine("connected");
                AppDomain.Unload(domain); // without Dispose
                Console.Out.WriteLine("unloaded");
            }
        }

        private void Play(string path)
        {
            _client = new HapticClient(new Options { ConnectionPath = path });
            _client.Start();
            while (_client.Status != ClientStatus.Connected)
            {
                _client.Tick();
                Thread.Sleep(5);
            }
        }
    }
}
