using System.IO;
using NUnit.Framework;
using UnityEngine;
using UnityEngine.TestTools;

namespace Pacinian.Haptics.Tests
{
    public sealed class ServerTests
    {
        private GameObject _first, _second;

        [SetUp]
        public void Stand()
        {
            _first = new GameObject("first");
            _second = new GameObject("second");
        }

        [TearDown]
        public void Clean()
        {
            UnityEngine.Object.DestroyImmediate(_first);
            UnityEngine.Object.DestroyImmediate(_second);
            HapticServer.StopServer();
            PacinianSettings.Forget();
        }

        [Test]
        public void ASecondOneSaysWhyItWaitsAndTakesOver()
        {
            HapticServer first = Server(_first), second = Server(_second);
            Assert.IsTrue(HapticServer.Current == first);
            Assert.AreEqual("", first.Problem);
            Assert.IsTrue(second.Problem.Contains("that of \"first\" is used"), second.Problem);
            Assert.AreEqual(second.Problem, second.Silence);
            second.Connect();
            Assert.IsTrue(second.Status == ClientStatus.Stopped);
            first.enabled = false;
            Assert.IsTrue(HapticServer.Current == second);
            second.SendMessage("Update");
            Assert.AreEqual("", second.Problem);
        }

        [Test]
        public void AnEmergencyStopThatIsNotConfirmedIsToldWithoutAConnection()
        {
            LogAssert.ignoreFailingMessages = true; // the stop logs an error
            HapticServer server = Server(_first);
            server.ConnectionFile = "/nonexistent/connection.json";
            server.EmergencyStop();
            System.DateTime end = System.DateTime.UtcNow.AddSeconds(60.0);
            while (server.Problem.Length == 0 && System.DateTime.UtcNow < end)
            {
                System.Threading.Thread.Sleep(10);
            }
            Assert.IsTrue(server.Problem.Contains("the stop was not confirmed"), server.Problem);
            Assert.IsTrue(server.Problem.Contains("switch the array off"));
        }

        [TestCase(0f, 0.0)]
        [TestCase(0.01f, 0.05)]
        [TestCase(1f, 1.0)]
        public void TheLeaseIsOneThatTheServerTakes(float lease, double wanted)
        {
            HapticServer server = Server(_first);
            server.Lease = lease;
            Assert.AreEqual(wanted, server.Choices().Lease, 1e-6);
        }

        [Test]
        public void AnArrayOriginThatGoesLeavesItsPlaceToTheNext()
        {
            ArrayOrigin first = _first.AddComponent<ArrayOrigin>(), second = _second.AddComponent<ArrayOrigin>();
            Assert.IsTrue(ArrayOrigin.Current == first);
            first.enabled = false;
            Assert.IsTrue(ArrayOrigin.Current == second);
        }

#if PACINIAN_STUBS // Unity tells neither what it keeps across scenes, nor lets its folders be set
        [Test]
        public void TheFirstMayStayWhenAnotherSceneIsLoaded()
        {
            int before = UnityEngine.Object.Kept.Count;
            _second.transform.SetParent(_first.transform, false);
            _second.SetActive(false);
            HapticServer server = Server(_second);
            server.KeepAcrossScenes = true;
            _second.SetActive(true);
            Assert.AreEqual(before + 1, UnityEngine.Object.Kept.Count);
            Assert.IsTrue(UnityEngine.Object.Kept[before] == _first, "with all that is above");
        }

        [Test]
        public void TheServerThatIsStartedIsTheProjectsOwnOrTheOneThatItNames()
        {
            PacinianSettings.Current.ServerCommand = "elsewhere/pacinian";
            Assert.AreEqual("elsewhere/pacinian", StartedServer.Program);
            string folder = Path.Combine(Path.GetTempPath(), "pacinian-test-" + System.Guid.NewGuid().ToString("N"));
            string before = Application.streamingAssetsPath;
            Application.SetStreamingAssetsPath(folder);
            Directory.CreateDirectory(Path.Combine(folder, "pacinian"));
            string own = Path.Combine(Path.Combine(folder, "pacinian"), Path.DirectorySeparatorChar == '/' ? "pacinian" : "pacinian.exe");
            File.WriteAllText(own, "");
            Assert.AreEqual(own, StartedServer.Program);
            Directory.Delete(folder, true);
            Application.SetStreamingAssetsPath(before);
        }
#endif

        private static HapticServer Server(GameObject owner)
        {
            HapticServer server = owner.AddComponent<HapticServer>();
            server.ConnectOnPlay = false;
            server.Disconnect();
            return server;
        }
    }
}
