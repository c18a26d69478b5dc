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

        [TestCase(1f, 1f, 1f, 1.0)]
        [TestCase(-1f, 1f, 1f, 1.0)]
        [TestCase(1f, 1f, -1f, 1.0)]
        [TestCase(1f, -1f, 1f, -1.0)]
        [TestCase(-1f, -1f, -1f, -1.0)]
        public void AMirroredSurfaceIsFeltOnItsVisibleSide(float x, float y, float z, double up)
        {
            _owner.transform.rotation = Quaternion.AngleAxis(30f, Vector3.up);
            _owner.transform.localScale = new Vector3(x, y, z);
            HapticSurface surface = _owner.AddComponent<HapticSurface>();
            foreach (HapticSurfaceShape shape in new[] { HapticSurfaceShape.Rectangle, HapticSurfaceShape.Disc, HapticSurfaceShape.Mesh })
            {
                surface.Shape = shape;
                surface.Mesh = Shapes.Square();
                Vec3 normal = surface.ShapePose.Direction(Normal(((Surface)Told(surface)).Shape));
                Assert.AreEqual(0.0, (new Vec3(0.0, 0.0, up) - normal).Length, 1e-6, shape + " mirrored");
            }
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

        /// <summary>Returns the normal of the felt side, in the frame of the shape.</summary>
        private static Vec3 Normal(IShell shape)
        {
            HapticMesh mesh = shape as HapticMesh;
            if (mesh == null)
            {
                return new Vec3(0.0, 0.0, 1.0);
            }
            Vec3 a = Corner(mesh, 0), b = Corner(mesh, 1), c = Corner(mesh, 2);
            Vec3 normal = Vec3.Cross(b - a, c - a);
            return (1.0 / normal.Length) * normal;
        }

        private static Vec3 Corner(HapticMesh mesh, int index)
        {
            return mesh.Vertices.Point((int)mesh.Faces.Index(index));
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
