using System.Collections.Generic;
using System.IO;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// Where the array stands: its middle is here, its sound goes up (y). Make it a child of the tracked space, as of the
    /// XR Origin's camera offset, so that it stays when the player is teleported. Without one it stands at the origin.
    /// Its pose there is found by touching known points of the array, and kept between sessions.
    /// </summary>
    [DisallowMultipleComponent]
    [DefaultExecutionOrder(-900)]
    [AddComponentMenu("Pacinian/Array Origin")]
    public sealed partial class ArrayOrigin : MonoBehaviour
    {
        private const float Length = 0.57f, Width = 0.46f; // [m] of the gizmo, while no server has told of its array

        private static readonly List<ArrayOrigin> All = new List<ArrayOrigin>(); // that are enabled

        [SerializeField, Tooltip("Points to touch, from the array's middle, y up [m]: 3 or more. Empty: the array's corners.")]
        private Vector3[] knownPoints = new Vector3[0];
        [SerializeField, Tooltip("By which the alignment is kept on this computer.")]
        private string calibrationName = "default";
        [SerializeField, Tooltip("Stands where it was kept, if it was.")]
        private bool loadOnStart = true;
        [SerializeField, Tooltip("Draws the array, as the server tells of it.")]
        private bool drawArray = true;

        /// <summary>The one that is used: the first that is enabled; null if there is none.</summary>
        public static ArrayOrigin Current
        {
            get { return All.Count > 0 ? All[0] : null; }
        }

        /// <summary>The array's frame in the world.</summary>
        internal static Rigid InWorld
        {
            get { return All.Count == 0 ? Rigid.Identity : Frames.Of(All[0].transform); }
        }

        /// <summary>The way from the world to the array's frame.</summary>
        internal static Rigid ToArray
        {
            get { return InWorld.Inverse; }
        }

        /// <summary>Points to touch, in the order in which they are touched, in this frame [m]; none: the array's corners.</summary>
        public Vector3[] KnownPoints
        {
            get { return knownPoints; }
            set { knownPoints = value ?? new Vector3[0]; }
        }

        /// <summary>By which the alignment is kept on this computer.</summary>
        public string CalibrationName
        {
            get { return calibrationName; }
            set { calibrationName = value ?? ""; }
        }

        /// <summary>Whether it stands where it was kept, when it is enabled.</summary>
        public bool LoadOnStart
        {
            get { return loadOnStart; }
            set { loadOnStart = value; }
        }

        /// <summary>Whether the array is drawn, by gizmos.</summary>
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
            Rigid frame = Frames.Of(transform);
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
                Gizmos.DrawSphere(Frames.Back(frame.Point(told.Positions.Point(i))), 0.004f);
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
