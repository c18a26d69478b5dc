using System;
using System.IO;
using System.Reflection;
using NUnit.Framework;
using Pacinian.Haptics.Editing;
using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class EditorTests
    {
        /// <summary>Also stops the server of a failed test.</summary>
        [TearDown]
        public void NoServerIsLeft()
        {
            EditorServer.Stop();
        }

        [Test]
        public void TheMenuMakesWhatASceneNeeds()
        {
            GameObjectMenu.Array(new MenuCommand(null));
            GameObject rig = Made();
            Assert.IsNotNull(rig.GetComponent<HapticServer>());
            Assert.IsNotNull(rig.GetComponent<ArrayOrigin>());
            Assert.IsNotNull(rig.GetComponent<EmissionView>());
            GameObjectMenu.Hand(new MenuCommand(rig));
            Assert.IsTrue(Made().GetComponent<HapticHand>().Source == HapticHandSource.Open);
            Assert.IsTrue(Made().transform.parent == rig.transform);
            GameObjectMenu.Ball(new MenuCommand(rig));
            Assert.IsNotNull(Made().GetComponent<HapticVolume>());
            Assert.AreEqual(0.03, Made().GetComponent<SphereCollider>().radius, 1e-6);
            Vector3 above = Made().transform.position - rig.transform.position;
            Assert.AreEqual(0.0, (above - new Vector3(0f, 0.175f, 0f)).magnitude, 1e-6);
            GameObjectMenu.Point(new MenuCommand(rig));
            Assert.IsNotNull(Made().GetComponent<HapticPoint>());
            GameObjectMenu.Quiet(new MenuCommand(rig));
            Assert.IsNotNull(Made().GetComponent<QuietZone>());
            UnityEngine.Object.DestroyImmediate(rig);
        }

        [Test]
        public void HandsComeInOneStepWithATrackerOrWithout()
        {
            GameObject offset = new GameObject("camera offset");
            GameObject camera = new GameObject("camera", typeof(Camera));
            camera.tag = "MainCamera";
            camera.transform.SetParent(offset.transform, false);
            GameObjectMenu.Hands(new MenuCommand(null), typeof(Follower));
            HapticHand[] hands = Made().GetComponentsInChildren<HapticHand>();
            Assert.AreEqual(3, hands.Length);
            Assert.IsTrue(hands[2].Source == HapticHandSource.Mouse);
            foreach (HapticHand hand in new[] { hands[0], hands[1] })
            {
                Follower provider = hand.GetComponent<Follower>();
                Assert.IsTrue(hand.Source == HapticHandSource.Tracker && hand.Provider == provider);
                Assert.IsTrue(provider.Side == hand.Side && provider.Origin == offset.transform);
                Assert.AreEqual(hand.Side.ToString(), hand.name);
            }
            UnityEngine.Object.DestroyImmediate(Made());
            GameObject array = new GameObject("array", typeof(ArrayOrigin));
            array.transform.position = new Vector3(1f, 2f, 3f);
            foreach (GameObject context in new[] { null, array }) // the main menu, and that of the array
            {
                GameObjectMenu.Hands(new MenuCommand(context), null);
                hands = Made().GetComponentsInChildren<HapticHand>();
                Assert.AreEqual(1, hands.Length);
                Assert.IsTrue(hands[0].Source == HapticHandSource.Mouse);
                Vector3 above = hands[0].transform.position - array.transform.position;
                Assert.AreEqual(0.0, (above - new Vector3(0f, 0.215f, 0f)).magnitude, 1e-6);
                UnityEngine.Object.DestroyImmediate(Made());
            }
            UnityEngine.Object.DestroyImmediate(array);
            UnityEngine.Object.DestroyImmediate(offset);
        }

        private sealed class Follower : HandProvider
        {
            public Wire.HandFrameSide Side { get; private set; }

            public Transform Origin { get; private set; }

            public override bool TryGet(Vector3[] positions, float[] radii)
            {
                return false;
            }

            public override void Follow(bool left, Transform origin)
            {
                Side = left ? Wire.HandFrameSide.Left : Wire.HandFrameSide.Right;
                Origin = origin;
            }
        }

        [Test]
        public void TheProgramIsTheChosenOneOrThatInThePath()
        {
            string before = ServerExecutable.Chosen;
            string file = Path.GetTempFileName();
            ServerExecutable.Chosen = file;
            Assert.AreEqual(file, ServerExecutable.Find());
            File.Delete(file);
            Assert.IsTrue(ServerExecutable.Find() != file);
            ServerExecutable.Chosen = before;
        }

        [Test]
        public void TheProgramIsThatOfTheInstallationUnlessOneIsChosen()
        {
            string before = ServerExecutable.Chosen;
            string noted = File.Exists(ServerExecutable.Note) ? File.ReadAllText(ServerExecutable.Note) : "";
            string file = Path.GetTempFileName();
            Directory.CreateDirectory(Path.GetDirectoryName(ServerExecutable.Note));
            ServerExecutable.Chosen = "";
            File.WriteAllText(ServerExecutable.Note, file + "\n");
            Assert.AreEqual(file, ServerExecutable.Find());
            File.Delete(file);
            Assert.IsTrue(ServerExecutable.Find() != file);
            File.WriteAllText(ServerExecutable.Note, noted);
            ServerExecutable.Chosen = before;
        }

        [Test]
        public void TheLibraryOfTheServersPythonIsFoundAndCopiedWithWhatItNeeds()
        {
            string root = Path.Combine(Path.GetTempPath(), "pacinian-test-" + Guid.NewGuid().ToString("N"));
            string libraries = Path.Combine(root, "lib/python3.12/site-packages/pyzmq.libs");
            Directory.CreateDirectory(libraries);
            string library = Path.Combine(libraries, "libzmq-12ab.so.5.2.5");
            File.WriteAllText(library, "zmq");
            File.WriteAllText(Path.Combine(libraries, "libsodium-34cd.so.26"), "sodium");
            string program = Path.Combine(root, "pacinian"); // a link, as pipx makes one
            File.WriteAllText(program, "#!" + root + "/bin/python\nimport sys");
            Assert.AreEqual(library, NativeLibrary.Find(program));
            string place = Path.Combine(root, "Plugins/libzmq.so");
            Assert.AreEqual("", NativeLibrary.Install(library, place));
            Assert.AreEqual("zmq", File.ReadAllText(place));
            Assert.AreEqual("sodium", File.ReadAllText(Path.Combine(root, "Plugins/libsodium-34cd.so.26")));
            Directory.Delete(root, true);
            Assert.IsTrue(NativeLibrary.Find(program) != library);
        }

        /// <summary>Does nothing if `pacinian` is not installed.</summary>
        [Test]
        public void AServerIsStartedAndStopped()
        {
            string file = Path.Combine(Path.GetTempPath(), "pacinian-test-" + Guid.NewGuid().ToString("N") + ".json");
            string program = ServerExecutable.Find();
            if (program.Length == 0 || file.Contains(" "))
            {
                return;
            }
            Assert.AreEqual("", EditorServer.Start(program, "--control 0 --command 0 --state 0 --connection " + file));
            Assert.IsTrue(EditorServer.Running);
            Until(() => File.Exists(file) || !EditorServer.Running, 60.0);
            Assert.IsTrue(File.Exists(file), EditorServer.Log());
            Forget();
            Assert.IsTrue(EditorServer.Running, "also after scripts were loaded anew");
            EditorServer.Stop();
            Until(() => !EditorServer.Running, 20.0);
            Assert.IsFalse(File.Exists(file), "the server takes its connection file with it");
        }

        [Test]
        public void AProgramThatIsMissingIsToldInTheLog()
        {
            string missing = Path.Combine(Path.GetTempPath(), "no such pacinian");
            Assert.AreEqual("", EditorServer.Start(missing, ""));
            Until(() => !EditorServer.Running, 10.0);
            Assert.IsTrue(EditorServer.Log().Length > 0);
        }

        private static void Forget()
        {
            const BindingFlags Own = BindingFlags.Static | BindingFlags.NonPublic;
            typeof(EditorServer).GetField("s_process", Own).SetValue(null, null);
        }

        private static GameObject Made()
        {
            return (GameObject)Selection.activeObject;
        }

        private static void Until(Func<bool> done, double limit)
        {
            DateTime end = DateTime.UtcNow.AddSeconds(limit);
            while (!done())
            {
                Assert.IsTrue(DateTime.UtcNow < end, EditorServer.Log());
                System.Threading.Thread.Sleep(10);
            }
        }
    }
}
