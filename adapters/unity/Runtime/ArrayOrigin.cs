using System.Collections.Generic;
using System.IO;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// The pose of the array: its middle is at this object, and it emits upwards (y). Make this object a child of the
    /// tracked space, such as the XR Origin's camera offset, so that the array stays in place when the player is
    /// teleported. Without an Array Origin, the array is at the world's origin. To find the pose, touch known points of
    /// the array; the pose is stored between sessions.
    /// </summary>
    [DisallowMultipleComponent]
    [DefaultExecutionOrder(-900)]
    [AddComponentMenu("Pacinian/Array Origin")]
    public sealed partial class ArrayOrigin : MonoBehaviour
    {
        private const float Length = 0.57f, Width = 0.46f; // [m] size of the gizmo until a server has described its array

        private static readonly List<ArrayOrigin> All = new List<ArrayOrigin>(); // the enabled ones

        [SerializeField, Tooltip("Points to touch, from the array's middle, y up [m]; at least 3. Empty: the array's corners.")]
        private Vector3[] knownPoints = new Vector3[0];
        [SerializeField, Tooltip("Name under which the alignment is stored on this computer.")]
        private string calibrationName = "default";
        [SerializeField, Tooltip("Apply the stored pose, if there is one.")]
        private bool loadOnStart = true;
        [SerializeField, Tooltip("Draw the array as the server describes it.")]
        private bool drawArray = true;

        /// <summary>The Array Origin in use: the first that was enabled; null if there is none.</summary>
        public static ArrayOrigin Current
        {
            get { return All.Count > 0 ? All[0] : null; }
        }

        /// <summary>The pose of the array's frame in the world.</summary>
        internal static Rigid InWorld
        {
            get { return All.Count == 0 ? Rigid.Identity : WireSpace.ToWire(All[0].transform); }
        }

        /// <summary>The transform from the world to the array's frame.</summary>
        internal static Rigid ToArray
        {
            get { return InWorld.Inverse; }
        }

        /// <summary>Points to touch, in order, in the array's frame [m]. If empty, the array's corners are used.</summary>
        public Vector3[] KnownPoints
        {
            get { return knownPoints; }
            set { knownPoints = value ?? new Vector3[0]; }
        }

        /// <summary>The name under which the alignment is stored on this computer.</summary>
        public string CalibrationName
        {
            get { return calibrationName; }
            set { calibrationName = value ?? ""; }
        }

        /// <summary>Whether the stored pose is applied when this component is enabled.</summary>
        public bool LoadOnStart
        {
            get { return loadOnStart; }
            set { loadOnStart = value; }
        }

        /// <summary>Whether gizmos show the array.</summary>
        public bool DrawArray
        {
            get { return drawArray; }
            set { drawArray = value; }
        }

        internal static void Forget()
        {
            All.Clear();
        }

        private void OnEnable()
        {
            if (All.Count > 0)
            {
                Debug.LogWarning(
                    "Pacinian: the Array Origin of \"" + name + "\" waits, because that of \"" + Current.name + "\" is used: disable one",
                    this);
            }
            All.Add(this);
            string problem = "";
            if (loadOnStart && File.Exists(Path) && !LoadCalibration(out problem))
            {
                Debug.LogWarning("Pacinian: " + problem, this);
            }
        }

        private void OnDisable()
        {
            All.Remove(this);
        }

        private void OnDrawGizmos()
        {
            if (!drawArray)
            {
                return;
            }
            Wire.Abilities told = HapticServer.Capabilities;
            Rigid frame = WireSpace.ToWire(transform);
            Gizmos.color = new Color(0.2f, 0.8f, 0.4f);
            if (told == null)
            {
                Gizmos.matrix = Matrix4x4.TRS(transform.position, transform.rotation, Vector3.one);
                Gizmos.DrawWireCube(Vector3.zero, new Vector3(Length, 0.01f, Width));
                Gizmos.matrix = Matrix4x4.identity;
            }
            int count = told == null ? 0 : told.Positions.Numbers / 3;
            for (int i = 0; i < count; i += 1 + count / 500)
            {
                Gizmos.DrawSphere(WireSpace.ToUnity(frame.Point(told.Positions.Point(i))), 0.004f);
            }
            Gizmos.DrawLine(transform.position, transform.position + transform.rotation * new Vector3(0f, 0.2f, 0f));
            for (int i = 0; i < _points.Length; i++)
            {
                Gizmos.color = i < _touched.Count ? Color.green : Color.yellow;
                Gizmos.DrawSphere(transform.position + transform.rotation * _points[i], 0.006f);
            }
        }
    }
}
