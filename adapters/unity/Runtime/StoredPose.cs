using System;
using System.IO;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>The aligned pose of the array in its parent's frame, stored as a readable file.</summary>
    [Serializable]
    internal sealed class StoredPose
    {
        public float x, y, z, qx, qy, qz, qw;
        public float residual, worst;

        public Vector3 Position
        {
            get { return new Vector3(x, y, z); }
        }

        public Quaternion Rotation
        {
            get { return new Quaternion(qx, qy, qz, qw); }
        }

        /// <summary>Returns the pose of a transform. residual, worst: of the alignment [m].</summary>
        public static StoredPose Of(Transform transform, float residual, float worst)
        {
            Vector3 p = transform.localPosition;
            Quaternion q = transform.localRotation;
            return new StoredPose
            {
                x = p.x, y = p.y, z = p.z, qx = q.x, qy = q.y, qz = q.z, qw = q.w, residual = residual, worst = worst,
            };
        }

        /// <summary>Writes the file, entirely or not at all. Returns "", or the reason for a failure.</summary>
        public string Save(string path)
        {
            try
            {
                string half = path + ".new";
                File.WriteAllText(half, JsonUtility.ToJson(this, true));
                if (File.Exists(path))
                {
                    File.Replace(half, path, null);
                }
                else
                {
                    File.Move(half, path);
                }
                return "";
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException)
            {
                return path + ": cannot be written: " + error.Message;
            }
        }

        /// <summary>Reads the file. Returns null and the reason if there is no complete one.</summary>
        public static StoredPose Load(string path, out string problem)
        {
            problem = "";
            try
            {
                StoredPose read = JsonUtility.FromJson<StoredPose>(File.ReadAllText(path));
                float length = read == null ? 0f : read.qx * read.qx + read.qy * read.qy + read.qz * read.qz + read.qw * read.qw;
                if (length > 0.99f && length < 1.01f && WireSpace.IsInRange(WireSpace.ToWire(0.01f * read.Position)))
                {
                    return read;
                }
                problem = path + ": is no stored pose: align the array again";
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException || error is ArgumentException)
            {
                problem = path + ": cannot be read: " + error.Message;
            }
            return null;
        }
    }
}
