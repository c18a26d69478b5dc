using System.Collections.Generic;

namespace UnityEngine
{
    /// <summary>Equals null once it is destroyed, as in Unity.</summary>
    public class Object
    {
        internal bool Destroyed;

        public string name { get; set; } = "";

        public static bool operator ==(Object a, Object b)
        {
            bool none = ReferenceEquals(a, null) || a.Destroyed;
            return none ? ReferenceEquals(b, null) || b.Destroyed : ReferenceEquals(a, b);
        }

        public static bool operator !=(Object a, Object b)
        {
            return !(a == b);
        }

        /// <summary>The objects that stay when another scene is loaded. Not in Unity.</summary>
        public static readonly List<Object> Kept = new List<Object>();

        public static void DontDestroyOnLoad(Object thing)
        {
            Kept.Add(thing);
        }

        public static void DestroyImmediate(Object thing)
        {
            Component component = thing as Component;
            GameObject owner = thing as GameObject;
            if (component is object)
            {
                component.gameObject.Remove(component);
            }
            if (owner is object)
            {
                owner.Empty();
            }
            thing.Destroyed = true;
        }

        public override bool Equals(object other)
        {
            return this == (other as Object);
        }

        public override int GetHashCode()
        {
            return System.Runtime.CompilerServices.RuntimeHelpers.GetHashCode(this);
        }
    }

    public class ScriptableObject : Object
    {
        public static T CreateInstance<T>()
            where T : ScriptableObject, new()
        {
            return new T();
        }
    }

    public class Component : Object
    {
        public GameObject gameObject { get; internal set; }

        public Transform transform
        {
            get { return gameObject.transform; }
        }

        public new string name
        {
            get { return gameObject.name; }
        }

        public T GetComponent<T>()
        {
            return gameObject.GetComponent<T>();
        }

        public void GetComponents<T>(List<T> results)
        {
            gameObject.GetComponents(results);
        }

        public bool TryGetComponent<T>(out T component)
        {
            component = GetComponent<T>();
            return component != null;
        }

        public void GetComponentsInChildren<T>(List<T> results)
        {
            results.Clear();
            gameObject.AddComponentsInChildren(results);
        }
    }

    public class Behaviour : Component
    {
        private bool _enabled = true;

        public bool enabled
        {
            get { return _enabled; }
            set
            {
                _enabled = value;
                Changed();
            }
        }

        public bool isActiveAndEnabled
        {
            get { return _enabled && gameObject.activeInHierarchy; }
        }

        internal virtual void Changed()
        {
        }
    }
}
