using System.IO;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// Where the array stands: its middle is here, its sound goes up (y). Make it a child of the tracked space, as of the
    /// XR Origin's camera offset, so that it stays when the player is teleported. Without one it stands at the origin.
    /// </summary>
    [DisallowMultipleComponent]
    [DefaultExecutionOrder(-900)]
    [AddComponentMenu("Pacinian/Array Origin")]
    public sealed class ArrayOrigin : MonoBehaviour
    {
        private static ArrayOrigin s_current;

        [SerializeField, Tooltip("Where its place is kept, in the game's persistent data; empty: it is not kept.")]
        private string file = "pacinian-array.json";
        [SerializeField, Tooltip("Stands where it was stored, if it was.")]
        private bool loadOnEnable = true;
        [SerializeField, Tooltip("Of the gizmo, while no server has told of its array: x, z [m].")]
        private Vector2 size = new Vector2(0.57f, 0.46f);

        /// <summary>The one that is enabled; null if there is none.</summary>
        public static ArrayOrigin Current
        {
            get { return s_current; }
        }

        /// <summary>The array's frame in the world.</summary>
        internal static Rigid InWorld
        {
            get { return s_current == null ? Rigid.Identity : Frames.Of(s_current.transform); }
        }

        /// <summary>The way from the world to the array's frame.</summary>
        internal static Rigid ToArray
        {
            get { return InWorld.Inverse; }
        }

        /// <summary>Where its place is kept; "" if it is not.</summary>
        public string Path
        {
            get { return file.Length == 0 ? "" : System.IO.Path.Combine(Application.persistentDataPath, file); }
        }

        /// <summary>How well it was aligned when it was stored [m]; 0 if that is not known.</summary>
        public float Residual { get; internal set; }

        /// <summary>Stores where it stands; "", or why that cannot be.</summary>
        public string Save()
        {
            return file.Length == 0 ? "no file is given" : StoredPose.Of(transform, Residual).Save(Path);
        }

        /// <summary>Stands where it was stored; "", or why that cannot be.</summary>
        public string Load()
        {
            string problem = "no file is given";
            StoredPose pose = file.Length == 0 ? null : StoredPose.Load(Path, out problem);
            if (pose != null)
            {
                transform.localPosition = pose.Position;
                transform.localRotation = pose.Rotation;
                Residual = pose.residual;
            }
            return problem;
        }

        internal static void Forget()
        {
            s_current = null;
        }

        private void OnEnable()
        {
            if (s_current != null)
            {
                Debug.LogWarning("Pacinian: there is an Array Origin already; this one is used now", this);
            }
            s_current = this;
            string problem = loadOnEnable && file.Length > 0 && File.Exists(Path) ? Load() : "";
            if (problem.Length > 0)
            {
                Debug.LogWarning("Pacinian: " + problem, this);
            }
        }

        private void OnDisable()
        {
            s_current = ReferenceEquals(s_current, this) ? null : s_current;
        }

        private void OnDrawGizmos()
        {
            HapticServer server = HapticServer.Current;
            Wire.Abilities told = server == null ? null : server.Capabilities;
            Rigid frame = Frames.Of(transform);
            Gizmos.color = new Color(0.2f, 0.8f, 0.4f);
            if (told == null)
            {
                Gizmos.matrix = Matrix4x4.TRS(transform.position, transform.rotation, Vector3.one);
                Gizmos.DrawWireCube(Vector3.zero, new Vector3(size.x, 0.01f, size.y));
                Gizmos.matrix = Matrix4x4.identity;
            }
            int count = told == null ? 0 : told.Positions.Numbers / 3;
            for (int i = 0; i < count; i += 1 + count / 500)
            {
                Gizmos.DrawSphere(Frames.Back(frame.Point(told.Positions.Point(i))), 0.004f);
            }
            Gizmos.DrawLine(transform.position, transform.position + transform.rotation * new Vector3(0f, 0.2f, 0f));
        }
    }
}
