using System;
using System.Threading;

namespace Pacinian.Tests
{
    /// <summary>
    /// A game that starts the server, executes commands from standard input, and prints the server's state. Arguments:
    /// connection file, log of the server, program, more arguments of the server.
    /// </summary>
    internal static class ClientServer
    {
        private static int Main(string[] words)
        {
            string more = string.Join(" ", words, 3, words.Length - 3);
            string said = "";
            bool ended = false;
            Thread reader = new Thread(() =>
            {
                for (string line = Console.ReadLine(); line != null && line != "end"; line = Console.ReadLine())
                {
                    while (Interlocked.CompareExchange(ref said, line, "") != "")
                    {
                        Thread.Sleep(1);
                    }
                }
                Volatile.Write(ref ended, true);
            });
            reader.IsBackground = true;
            reader.Start();
            using (ServerProcess server = new ServerProcess(words[2], words[0], words[1], more))
            using (HapticClient client = new HapticClient(new Options { ConnectionPath = words[0] }))
            {
                client.Start();
                server.Start();
                for (; !Volatile.Read(ref ended); Thread.Sleep(10))
                {
                    bool connected = client.Status == ClientStatus.Connected;
                    client.Tick();
                    server.Tick(connected);
                    string what = Interlocked.Exchange(ref said, "");
                    if (what == "stop")
                    {
                        server.Stop();
                    }
                    else if (what == "status")
                    {
                        ClientJson.Say("status", connected, "runs", server.Running, "problem", server.Problem);
                    }
                }
            }
            return 0;
        }
    }
}
