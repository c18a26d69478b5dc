using NUnit.Framework;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class SurfaceTests
    {
        private GameObject _owner;

        [SetUp]
        public void Stand()
        {
            _owner = new GameObject("surface");
        }

        [TearDown]
        public void Clean()
        {
            UnityEngine.Object.DestroyImmediate(_owner);
        }

        [Test]
        public void ARectangleAndADiscTakeTheScale()
        {
            _owner.transform.localScale = new Vector3(2f, 5f, 3f);
            HapticSurface surface = _owner.AddComponent<HapticSurface>();
            surface.Shape = HapticSurfaceShape.Rectangle;
            Rectangle rectangle = (Rectangle)((Surface)Told(surface)).Shape;
            Assert.AreEqual(0.2, rectangle.Width, 1e-6);
            Assert.AreEqual(0.3, rectangle.Height, 1e-6, "Unity's z");
            surface.Shape = HapticSurfaceShape.Disc;
            Assert.AreEqual(0.15, ((Disc)((Surface)Told(surface)).Shape).Radius, 1e-6);
        }

        [Test]
        public void AMeshIsTheOneThatIsGivenOrTheFilters()
        {
            HapticVolume volume = _owner.AddComponent<HapticVolume>();
            volume.Shape = HapticVolumeShape.Mesh;
            Assert.IsNull(Told(volume));
            _owner.AddComponent<MeshFilter>().sharedMesh = Shapes.Cube();
            Assert.IsTrue(((Volume)Told(volume)).Shape is HapticMesh);
            _owner.GetComponent<MeshFilter>().sharedMesh = null;
            volume.Mesh = Shapes.Cube();
            volume.Felt = HapticFelt.Interior;
            Assert.IsTrue(((Volume)Told(volume)).Felt == VolumeFelt.Interior);
        }

        private static HapticObject Told(HapticEffect effect)
        {
            string problem;
            HapticObject made = effect.Describe(out problem);
            Assert.AreEqual(made == null, problem.Length > 0, problem);
            return made;
        }
    }
}
